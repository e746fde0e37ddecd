// Runs the scripts of polhode submit with stand-ins for the engines; tests/reliability/clusters runs the real engines.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <regex>

#include "app/program_fixture.h"
#include "app/submit_scripts.h"

namespace polhode {
namespace {

class Submit : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        std::ofstream(directory / "e.json")
            << R"({"name": "e", "scenes": ["free_asymmetric"], "methods": ["odeint_dopri5"],
                   "settings": {"tolerances": [1e-4]}, "vary": {"/duration": [1, 2, 3]}, "samples": 5, "repeats": 1})";
    }
    // a test program that precedes others on the PATH
    void add_program(const std::string& name, const std::string& script) const {
        fs::create_directories(directory / "bin");
        std::ofstream(directory / "bin" / name) << "#!/usr/bin/env bash\n" << script;
        ::chmod((directory / "bin" / name).c_str(), 0700);
    }
    int bash(const std::string& words) const {
        const std::string command = "cd '" + directory.string() +
                                    "' && export POLHODE_CACHE=\"$PWD/cache\" PATH=\"$PWD/bin:$PATH\"; " + words +
                                    " >>log 2>&1";
        const int status =
            std::system(("bash -c '" + std::string("source /dev/stdin") + "' <<'END'\n" + command + "\nEND").c_str());
        return WEXITSTATUS(status);
    }
};

TEST(SubmitScripts, AShellTakesEveryWordBackAsItWas) {
    for (const std::string text :
         {"plain", "", "a b", "it's", "$(touch x)", "`x`", "\"", "\\", "a\nb", "-n", "*", "~", "#x"}) {
        const std::string command = "printf %s " + shell_word(text);
        FILE* pipe = ::popen(command.c_str(), "r");
        ASSERT_NE(pipe, nullptr);
        std::string back;
        for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) back += static_cast<char>(c);
        ::pclose(pipe);
        EXPECT_EQ(back, text == "-n" ? "-n" : text);
    }
}

TEST(SubmitScripts, FillEachPlaceholderOnce) {
    Submission s;
    s.name = "e", s.program = "/a/@name@", s.experiment = "x y", s.output = "/o", s.plan = "/o/e.plan.csv";
    s.options = {"--quick"}, s.shards = 3, s.jobs = 2, s.seconds = 61;
    for (const std::string engine : {"slurm", "parallel", "snakemake"}) {
        const std::string script = submit_script(engine, s);
        const std::regex placeholder("@[a-z_]+@");
        const std::vector<std::string> left{std::sregex_token_iterator(script.begin(), script.end(), placeholder), {}};
        EXPECT_EQ(left, std::vector<std::string>{"@name@"}) << engine;  // from the path of the program
    }
    EXPECT_NE(submit_script("slurm", s)
                  .find("program='/a/@name@'\nexperiment='x y'\noutput=/o\nplan=/o/e.plan.csv\n"
                        "shards=3\njobs=2\noptions=( --quick)\nmerge_options=()\n"
                        "time=0-00:02:00\nname=e\n"),
              std::string::npos);
    EXPECT_NE(submit_script("snakemake", s).find("OPTIONS = [\"--quick\"]\nMERGE_OPTIONS = []\n"), std::string::npos);
    EXPECT_THROW(submit_script("cron", s), std::invalid_argument);
}

TEST(SubmitScripts, TimesAreWrittenAsSlurmReadsThem) {
    EXPECT_EQ(slurm_time(1), "0-00:01:00");
    EXPECT_EQ(slurm_time(61), "0-00:02:00");
    EXPECT_EQ(slurm_time(86400 + 3600), "1-01:00:00");
}

TEST_F(Submit, ASlurmScriptSubmitsArraysThatTheClusterTakesAndAMergeBehindThem) {
    ASSERT_EQ(run({"submit", "slurm", "e.json", "--shards", "5", "--output", "o u't"}).exit_code, 0);
    add_program("scontrol", "echo 'MaxArraySize            = 3'\n");
    // a stand-in that runs jobs at once and the tasks of an array in sequence
    add_program("sbatch", R"(
echo "$*" >>"$PWD/submitted"
number=$(($(cat number 2>/dev/null || echo 0) + 1)); echo $number >number
array= words=()
for word; do
    case $word in --array=*) array=${word#--array=1-} ;; --*) ;; *) words+=("$word") ;; esac
done
for ((task = 1; task <= ${array:-1}; ++task)); do
    SLURM_ARRAY_JOB_ID=$number SLURM_ARRAY_TASK_ID=$task bash "${words[@]}" >&2 || true
done
echo "$number;cluster"
)");
    ASSERT_EQ(bash("bash \"o u't/e.slurm.sh\" --partition=p"), 0) << read(directory / "log");
    const std::string submitted = read(directory / "submitted");
    EXPECT_EQ(lines(submitted), 4) << submitted;  // five shards in arrays of two, and the merge
    EXPECT_NE(submitted.find("--array=1-2"), std::string::npos);
    EXPECT_NE(submitted.find("--array=1-1"), std::string::npos);
    EXPECT_NE(submitted.find("--dependency=afterany:1:2:3"), std::string::npos) << submitted;
    EXPECT_NE(submitted.find("--requeue"), std::string::npos);
    EXPECT_NE(submitted.find("--partition=p"), std::string::npos);
    EXPECT_EQ(lines(read(directory / "o u't" / "e.csv")), 4) << read(directory / "log");
    EXPECT_EQ(run({"merge", "o u't/shards/1", "o u't/shards/2", "--output", "part", "--quiet"}).exit_code, 1);
}

TEST_F(Submit, AShardThatIsOutOfTimeOrKilledIsQueuedAgain) {
    ASSERT_EQ(run({"submit", "slurm", "e.json", "--shards", "1", "--output", "out", "--program",
                   (directory / "bin" / "polhode").string()})
                  .exit_code,
              0);
    add_program("scontrol", "echo \"$*\" >>\"$PWD/asked\"\n");
    // ends on SIGTERM, as polhode does
    add_program("polhode", "trap 'exit 130' TERM\nkill -USR1 $PPID\nfor i in {1..100}; do sleep 0.1; done\n");
    EXPECT_NE(bash("SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=1 bash out/e.slurm.sh shard 0"), 0);
    EXPECT_EQ(read(directory / "asked"), "requeue 7_1\n") << read(directory / "log");
    add_program("polhode", "kill -KILL $$\n");
    bash("SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=2 bash out/e.slurm.sh shard 0");
    EXPECT_EQ(read(directory / "asked"), "requeue 7_1\nrequeue 7_2\n");
    // not more than five times, and not after exit code 2
    bash("SLURM_RESTART_COUNT=5 SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=3 bash out/e.slurm.sh shard 0");
    add_program("polhode", "exit 2\n");
    EXPECT_EQ(bash("SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=4 bash out/e.slurm.sh shard 0"), 2);
    EXPECT_EQ(read(directory / "asked"), "requeue 7_1\nrequeue 7_2\n");
}

TEST_F(Submit, BadUsageIsRefused) {
    const std::string e = (directory / "e.json").string();
    const auto refused = [&](const std::vector<std::string>& words, const std::string& named) {
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
        EXPECT_NE(outcome.err.find(named), std::string::npos) << outcome.err;
    };
    refused({"submit", "cron", e, "--shards", "2"}, "cron");
    refused({"submit", "slurm", e}, "--shards");
    refused({"submit", "slurm", e, "--shards", "0"}, "--shards is 0");
    refused({"submit", "slurm", e, "--shards", "2", "--jobs", "0"}, "--jobs is 0");
    refused({"submit", "slurm", "nothing.json", "--shards", "2"}, "nothing.json");
    refused({"submit", "slurm", e, "--shards", "2", "--output", "a\nb"}, "control characters");
    refused({"run", e, "--plan", "p.csv"}, "--plan");
    refused({"run", e, "--shard", "1/2", "--plan", "p.csv"}, "p.csv");
    refused({"run", e, "--measured", "x"}, "--measured");
    refused({"merge", "--output", "x"}, "DIR");
    refused({"merge", "nowhere", "--output", "x"}, "nowhere");
    refused({"merge", ".", "--output", "e.json"}, "--output is e.json, not a directory");
    EXPECT_FALSE(fs::exists(directory / "x"));
}

}  // namespace
}  // namespace polhode
