// The program from a script: exit codes, stdout, stderr, files.
#include <fmt/format.h>
#include <sys/prctl.h>

#include <nlohmann/json.hpp>

#include "app/program_fixture.h"
#include "bad_files.h"
#include "build_kind.h"
#include "integrators/method.h"
#include "motion/trajectory_csv.h"
#include "places.h"
#include "scene/scene_file.h"
#include "scene/scene_keys.h"

namespace polhode {
namespace {

// Files of tests/DIRECTORY/bad: the program ends at once with exit code 2 and one line on stderr and writes nothing.
class BadFiles : public Program {
  protected:
    void expect_refused_whole(const std::string& room, const std::string& ending,
                              const std::function<std::vector<std::string>(const std::string&)>& command) const {
        for (const BadFile& bad : bad_files(room, ending)) {
            if (is_read_by_check(bad)) continue;
            const Outcome outcome = run(command(bad.path));
            SCOPED_TRACE(bad.path + "\n" + outcome.err);
            EXPECT_EQ(outcome.exit_code, 2);
            EXPECT_EQ(outcome.out, "");
            EXPECT_EQ(lines(outcome.err), 1);
            EXPECT_NE(outcome.err.find(fs::path(bad.path).filename().string()), std::string::npos);
            EXPECT_NE(outcome.err.find(bad.place), std::string::npos) << "wanted: " << bad.place;
            EXPECT_TRUE(fs::is_empty(directory)) << "a file was written";
            EXPECT_LT(outcome.seconds, 5);
        }
    }
};

TEST_F(BadFiles, ScenesAreRefused) {
    expect_refused_whole("scene", ".json", [](const std::string& path) -> std::vector<std::string> {
        return {"solve", path, "--output", "trajectory.csv", "--allow-outside"};  // for ../bodies
    });
}

TEST_F(BadFiles, ExperimentsAreRefused) {
    expect_refused_whole("experiment", ".json", [](const std::string& path) -> std::vector<std::string> {
        return {"run", path, "--output", "tables"};
    });
}

TEST_F(BadFiles, TrajectoriesAreRefused) {
    expect_refused_whole("motion", ".csv", [](const std::string& path) -> std::vector<std::string> {
        return {"check", "free_asymmetric", path};
    });
}

TEST_F(Program, RefusesBadUsage) {
    const std::string scene = "free_asymmetric";
    expect_refused({}, "subcommand");
    expect_refused({"slove", scene}, "did you mean solve?");
    expect_refused({"solve"}, "SCENE");
    expect_refused({"solve", "free_asymetric"}, "did you mean free_asymmetric?");
    expect_refused({"solve", "no/such/file.json"}, "No such file");
    expect_refused({"solve", "/"}, "Is a directory");
    expect_refused({"solve", scene, "--method", "odeint_rk5"}, "did you mean odeint_rk4");
    expect_refused({"solve", scene, "--method", "rk45"}, "odeint_dopri5");
    expect_refused({"solve", scene, "--methd", "odeint_rk4"}, "--methd");
    for (const char* option : {"--step", "--tolerance", "--duration", "--max-seconds"})
        for (const char* value : {"0", "-1", "nan", "inf", "-inf", "x", ""})
            expect_refused({"solve", scene, option, value}, option);
    for (const char* option : {"--steps", "--samples", "--max-steps", "--max-evaluations"})
        for (const char* value : {"0", "-1", "1.5", "x", "", "99999999999999999999"})
            expect_refused({"solve", scene, option, value}, option);
    for (const char* option : {"--method", "--output"}) expect_refused({"solve", scene, option, ""}, option);
    expect_refused({"solve", ""}, "SCENE");
    for (const char* option : {"--output", "--digits", "--format"})
        expect_refused({"truth", scene, option, ""}, option);
    for (const char* option : {"--output", "--filter", "--shard"})
        expect_refused({"run", "contrast", option, ""}, option);
    expect_refused({"solve", scene, "--samples", "1000000000"}, "--samples");
    expect_refused({"solve", scene, "--step", "0.1", "--steps", "10"}, "--step");
    expect_refused({"solve", scene, "--step", "0.1", "--tolerance", "1e-6"}, "--step");
    expect_refused({"solve", scene, "--method", "odeint_rk4", "--tolerance", "1e-6"}, "does not take a tolerance");
    expect_refused({"solve", scene, "--method", "cvode_adams", "--step", "0.1"}, "does not take a step");
    expect_refused({"solve", scene, "--output", "no/such/directory.csv"}, "No such file");
    expect_refused({"solve", scene, "--output", "."}, "Is a directory");
    for (const std::string& expression :
         {std::string("("), std::string(100'000, '('), std::string("(((a{1,250}){1,250}){1,250}){1,250}")})
        expect_refused({"run", "work_precision", "--filter", expression, "--output", "tables"}, "--filter");
    expect_refused({"describe", "nothing_like_it"}, "nothing_like_it");
    expect_refused({"describe", "cvode_adam"}, "did you mean cvode_adams");
    expect_refused({"list", "things"}, "things");
    expect_refused({"list", "scenes", "--format", "xml"}, "xml");
}

TEST_F(Program, SolvesToStdoutAndToAFileAlike) {
    const std::vector<std::string> solve{"solve",  "lagrange_top", "--method",  "odeint_rk4",
                                         "--step", "1e-3",         "--samples", "10"};
    const Outcome printed = run(solve);
    EXPECT_EQ(printed.exit_code, 0) << printed.err;
    EXPECT_EQ(lines(printed.out), 12);
    EXPECT_TRUE(printed.out.starts_with("t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n0,"));
    std::vector<std::string> to_file = solve;
    to_file.insert(to_file.end(), {"--output", "trajectory.csv"});
    const Outcome written = run(to_file);
    EXPECT_EQ(written.exit_code, 0) << written.err;
    EXPECT_EQ(written.out, "");
    // only the file has the comment on its columns
    const std::string file = read(directory / "trajectory.csv");
    EXPECT_EQ(file.substr(0, printed.out.size()), printed.out);
    EXPECT_EQ(file.find("# SI; q maps body to world"), printed.out.size());
    EXPECT_EQ(std::distance(fs::directory_iterator(directory), fs::directory_iterator()), 1)
        << "a temporary file remains";
    // the same bits as from the library
    Settings settings;
    settings.step = 1e-3, settings.samples = 10;
    EXPECT_EQ(printed.out,
              trajectory_csv(polhode::solve(find_scene("lagrange_top"), *find_method("odeint_rk4"), settings)));
}

// With machine code or the interpreter, with any instruction set, and if the system forbids generated code.
TEST_F(Program, GivesTheSameBitsWithAndWithoutMachineCode) {
    const auto set = [](const char* name, const char* value) { return [=] { ::setenv(name, value, 1); }; };
    const std::function<void()> ways[] = {
        set("POLHODE_CODE", "interpreted"), set("POLHODE_INSTRUCTION_SET", "avx2"),
        set("POLHODE_INSTRUCTION_SET", "plain"),
        // PR_SET_MDWE (Linux 6.3): memory cannot become executable; older systems ignore it
        [] { ::prctl(65, 1, 0, 0, 0); }};
    for (const char* const scene : {"every_load", "lagrange_top", "mechanisms/double_pendulum", "mechanisms/four_bar"})
        for (const char* const method : {"taylor", "extrapolation"}) {
            std::vector<std::string> arguments{"solve", scene, "--method", method, "--samples", "3"};
            arguments.insert(arguments.end(), {"--tolerance", "1e-9"});
            const Outcome usual = run(arguments);
            EXPECT_EQ(usual.exit_code, 0) << usual.err;
            for (const auto& way : ways) EXPECT_EQ(run(arguments, way).out, usual.out) << scene << " " << method;
        }
}

TEST_F(Program, StopsAtTheLimitsThatItIsGiven) {
    for (const auto& [option, value, words] : {std::tuple("--max-evaluations", "50", "limit of 50 evaluations"),
                                               {"--max-seconds", "1e-9", "limit of 1e-09 s"}}) {
        const Outcome outcome = run({"solve", "free_asymmetric", "--method", "odeint_dopri5", option, value});
        EXPECT_EQ(outcome.exit_code, 1);
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    }
}

TEST_F(Program, ReportsARoundedStep) {
    const Outcome rounded = run({"solve", "free_asymmetric", "--method", "odeint_rk4", "--step", "0.03"});
    EXPECT_NE(rounded.err.find("0.029411764705882353 s, rounded down from 0.03 s"), std::string::npos) << rounded.err;
    const Outcome whole = run({"solve", "free_asymmetric", "--method", "odeint_rk4", "--step", "0.05"});
    EXPECT_EQ(whole.err.find("rounded"), std::string::npos) << whole.err;
    EXPECT_NE(whole.err.find("2000 steps"), std::string::npos) << whole.err;
    const Outcome counted = run({"solve", "free_asymmetric", "--method", "odeint_rk4", "--steps", "2000"});
    EXPECT_EQ(counted.out, whole.out);
}

TEST_F(Program, FailuresExitWithCode1) {
    const Outcome stopped =
        run({"solve", "free_asymmetric", "--method", "odeint_dopri5", "--tolerance", "1e-8", "--max-steps", "50"});
    EXPECT_EQ(stopped.exit_code, 1);
    EXPECT_NE(stopped.err.find("failed"), std::string::npos) << stopped.err;
    EXPECT_NE(stopped.out.find("\n# failed: "), std::string::npos);
    const Outcome not_begun =
        run({"solve", "free_asymmetric", "--method", "odeint_rk4", "--step", "1e-300", "--max-steps", "50"});
    EXPECT_EQ(not_begun.exit_code, 1);
    EXPECT_NE(not_begun.err.find("needs more than the limit of 50 steps"), std::string::npos) << not_begun.err;
    const Outcome full_disk = run({"solve", "free_asymmetric", "--output", "/dev/full"});
    EXPECT_EQ(full_disk.exit_code, 1);
    EXPECT_NE(full_disk.err.find("No space left"), std::string::npos) << full_disk.err;
}

TEST_F(Program, TakesTheDurationGiven) {
    const Outcome outcome = run({"solve", "free_asymmetric", "--duration", "2.5", "--samples", "1"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NE(outcome.out.find("\n2.5,"), std::string::npos) << outcome.out;
}

TEST_F(Program, ReadsAUsersFile) {
    std::ofstream(directory / "mine.json")
        << R"({"name": "mine", "duration": 1, "body": {"mass": 1, "inertia": [1, 2, 3]}}  // at rest)";
    const Outcome outcome = run({"solve", "mine.json", "--samples", "1"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out,
              "t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n0,1,0,0,0,0,0,0,0,0,0,0,0,0\n1,1,0,0,0,0,0,0,0,0,0,0,0,0\n");
}

TEST_F(Program, AutoTakesAMethodThatTakesWhatIsGiven) {
    for (const char* scene : {"free_asymmetric", "lagrange_top", "stiff_drag", "nasa_brick"}) {
        const Outcome tolerance = run({"solve", scene, "--tolerance", "1e-6", "--samples", "2"});
        EXPECT_EQ(tolerance.exit_code, 0) << tolerance.err;
        EXPECT_NE(tolerance.err.find("tolerance 1e-06"), std::string::npos) << tolerance.err;
    }
    for (const char* scene : {"free_asymmetric", "lagrange_top"}) {
        const Outcome step = run({"solve", scene, "--step", "0.01", "--samples", "2"});
        EXPECT_EQ(step.exit_code, 0) << step.err;
        EXPECT_NE(step.err.find("that takes a step"), std::string::npos) << step.err;
    }
}

TEST_F(Program, ShowsASceneAsItIsWritten) {
    const std::string text =
        "{\"name\": \"mine\", \"duration\": 1, \"body\": {\"mass\": 1, \"inertia\": [1, 2, 3]}}  // at rest\n";
    std::ofstream(directory / "mine.json") << text;
    EXPECT_EQ(run({"show", "mine.json"}).out, text);
    std::ifstream file(source_dir() + "/experiments/scenes/t_handle.json");
    const std::string built_in(std::istreambuf_iterator<char>(file), {});
    EXPECT_EQ(run({"show", "t_handle"}).out, built_in);
    EXPECT_EQ(run({"show", "no_such_scene"}).exit_code, 2);
}

TEST_F(Program, HelpsOnEveryCommand) {
    EXPECT_EQ(run({"--help"}).exit_code, 0);
    for (const char* command : {"solve", "truth", "check", "plot", "describe", "show", "list", "run"}) {
        const Outcome help = run({command, "--help"});
        EXPECT_EQ(help.exit_code, 0) << command;
        EXPECT_NE(help.out.find("--help"), std::string::npos) << command;
        EXPECT_EQ(help.err, "") << command;
    }
}

TEST_F(Program, NamesTheVersionsInUse) {
    const Outcome version = run({"--version"});
    EXPECT_EQ(version.exit_code, 0);
    for (const char* name : {"polhode ", "SUNDIALS ", "Boost ", "Eigen ", "MPFR ", "fmt ", "JSON", "CLI11 "})
        EXPECT_NE(version.out.find(name), std::string::npos) << name;
}

TEST_F(Program, ListsAsTextAndAsJson) {
    for (const char* what : {"scenes", "methods", "experiments", "metrics"}) {
        const Outcome text = run({"list", what}), json = run({"list", what, "--format", "json"});
        EXPECT_EQ(text.exit_code, 0);
        const auto entries = nlohmann::json::parse(json.out);
        EXPECT_EQ(lines(text.out), static_cast<long>(entries.size())) << what;
        for (const auto& entry : entries) {
            std::string line_start("\n");
            line_start += entry["name"].get<std::string>();
            EXPECT_NE(("\n" + text.out).find(line_start), std::string::npos);
        }
    }
    EXPECT_NE(run({"list", "scenes"}).out.find("nasa_brick"), std::string::npos);
    EXPECT_NE(run({"list", "metrics"}).out.find("attitude_error_max"), std::string::npos);
}

TEST_F(Program, TheCataloguesIndexIsTheOneGenerated) {
    const Outcome listed = run({"list", "scenes", "--format", "markdown"});
    EXPECT_EQ(listed.exit_code, 0) << listed.err;
    for (std::string name : builtin_scene_names()) {
        // as escaped in Markdown, where _- could start emphasis
        if (const std::size_t at = name.find("_-"); at != std::string::npos) name.insert(at, 1, '\\');
        const std::string begin = fmt::format("\n| {} ", name);
        const std::size_t row = listed.out.find(begin);
        EXPECT_NE(row, std::string::npos) << name;
        EXPECT_EQ(listed.out.find(begin, row + 1), std::string::npos) << name;
    }
    const std::string index = read(fs::path(source_dir()) / "experiments/scenes/README.md");
    EXPECT_TRUE(index.ends_with("\n\n" + listed.out)) << "run experiments/update_readme";
}

TEST_F(Program, TheReferenceOfKeysColumnsAndConstructsIsTheOneGenerated) {
    for (const auto& [what, file] : {std::pair("keys", "reference.md"), std::pair("columns", "reference.md"),
                                     std::pair("constructs", "robots.md"), std::pair("formulas", "formulas.md")}) {
        const std::string page = read(fs::path(source_dir()) / "experiments" / file);
        const Outcome listed = run({"list", what, "--format", "markdown"});
        EXPECT_EQ(listed.exit_code, 0) << listed.err;
        EXPECT_NE(page.find(fmt::format("<!-- begin: {0} -->\n{1}<!-- end: {0} -->", what, listed.out)),
                  std::string::npos)
            << "run experiments/update_readme";
    }
}

// The reader accepts each key of the reference: with an unknown key added, it reports only the unknown key.
TEST_F(Program, EveryKeyOfTheReferenceIsRead) {
    for (const FileKey& key : scene_keys()) {
        if (!key.object.starts_with("load ") && key.object != "scene" && key.object != "plane" &&
            key.object != "initial")
            continue;
        const std::string object =
            fmt::format(R"({{"{}": {}, "zzz": 1)", key.key, key.key == "type" ? key.example : "0");
        const std::string type = key.key != "type" && key.object.starts_with("load ")
                                     ? fmt::format(R"(, "type": "{}")", key.object.substr(5))
                                     : "";
        const std::string whole = object + type + "}";
        const std::string scene = R"({"name": "a", "duration": 1, "body": {"mass": 1, "inertia": [1, 1, 1]}, )";
        std::ofstream file(directory / "s.json");
        if (key.object == "scene")
            file << whole;
        else if (key.object == "plane")
            file << scene << "\"planes\": [" << whole << "]}";
        else if (key.object == "initial")
            file << scene << "\"initial\": " << whole << "}";
        else
            file << scene << "\"loads\": [" << whole << "]}";
        file.close();
        const Outcome outcome = run({"describe", "s.json"});
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_NE(outcome.err.find("zzz"), std::string::npos) << key.object << key.key << outcome.err;
    }
}

TEST_F(Program, DrawsAPolhodeOrReportsWhyNot) {
    const Outcome page = run({"describe", "free_asymmetric"});
    const Outcome to_file = run({"describe", "free_asymmetric", "--output", "page.txt"});
    EXPECT_EQ(to_file.exit_code, 0) << to_file.err;
    EXPECT_EQ(to_file.out, "");
    EXPECT_EQ(read(directory / "page.txt"), page.out);
    for (const char* name : {"polhode.svg", "polhode.pdf"}) {
        const Outcome drawn = run({"describe", "free_asymmetric", "--picture", name});
        EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
        EXPECT_EQ(drawn.out + drawn.err, "");
        const std::string first = read(directory / name);
        EXPECT_EQ(run({"describe", "free_asymmetric", "--picture", name}).exit_code, 0);
        EXPECT_EQ(read(directory / name), first) << "different bytes";
    }
    EXPECT_NE(read(directory / "polhode.svg").find("</svg>"), std::string::npos);
    EXPECT_NE(read(directory / "polhode.svg").find("free_asymmetric"), std::string::npos);
    for (const auto& entry : fs::directory_iterator(directory)) fs::remove(entry);
    expect_refused({"describe", "free_asymmetric", "--picture", "polhode.png"}, ".svg");
    expect_refused({"describe", "free_asymmetric", "--picture", ""}, "--picture");
    expect_refused({"describe", "free_asymmetric", "--picture", "no/such/directory.svg"}, "No such file");
    expect_refused({"describe", "cvode_adams", "--picture", "polhode.svg"}, "method");
    const Outcome rest = run({"describe", "at_rest", "--picture", "polhode.svg"});
    EXPECT_EQ(rest.exit_code, 1);
    EXPECT_NE(rest.err.find("does not rotate"), std::string::npos) << rest.err;
    EXPECT_TRUE(fs::is_empty(directory));
}

TEST_F(Program, DescribesEverySceneAndMethod) {
    const std::vector<std::string> names = builtin_scene_names();
    for (std::size_t i = 0; i < names.size(); i += optimised_build ? 1 : 6) {
        const std::string& name = names[i];
        const Outcome outcome = run({"describe", name});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        std::vector<const char*> parts{"System posed", "Omitted, and why", "Method selected by auto", "Invariants",
                                       "Conditioning"};
        if (is_mechanism(find_scene(name)))
            parts.insert(parts.end(), {"Tree", "Bodies at the start"});
        else
            parts.insert(parts.end(), {"Mass properties", "Polhode"});
        for (const char* part : parts) EXPECT_NE(outcome.out.find(part), std::string::npos) << name << ": " << part;
    }
    for (const Method* method : methods()) {
        const Outcome outcome = run({"describe", std::string(method->name)});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_NE(outcome.out.find("control"), std::string::npos) << method->name;
    }
}

TEST_F(Program, DescribesHowEnsemblesAreSolved) {
    const std::vector<std::pair<const char*, const char*>> expected{
        {"free_asymmetric", "rows are solved side by side"},
        {"formulas/quadratic_drag", "rows are solved side by side"},
        {"mechanisms/double_pendulum", "rows are solved side by side"},
        {"formulas/saturated_regulator", "rows are solved one by one: formulas with switching points"},
        {"bouncing_ball", "rows are solved one by one: planes"},
        {"joints/coulomb_pendulum", "rows are solved one by one: limits, friction or prescribed motions of joints"},
        {"mechanisms/andrews_squeezer", "rows are solved one by one: loops or couplings"}};
    for (const auto& [scene, line] : expected) {
        const Outcome outcome = run({"describe", scene});
        EXPECT_NE(outcome.out.find(line), std::string::npos) << scene << ": " << outcome.out;
    }
}

TEST_F(Program, ReportsWhyAMethodIsOmitted) {
    const std::string list = run({"list", "methods", "--format", "markdown"}).out;
    ASSERT_FALSE(omitted_methods().empty());
    for (const OmittedMethod& method : omitted_methods()) {
        EXPECT_EQ(find_method(method.name), nullptr);
        const Outcome outcome = run({"describe", std::string(method.name)});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_NE(outcome.out.find(method.reason), std::string::npos) << outcome.out;
        EXPECT_NE(list.find(method.reason), std::string::npos) << list;
        expect_refused({"solve", "free_asymmetric", "--method", std::string(method.name)}, "prints why");
    }
}

TEST_F(Program, DescribesWhatASphereASymmetricAndALoadedBodyDoNotNeed) {
    const auto described = [&](const std::string& members) {
        std::ofstream(directory / "body.json") << R"({"name": "b", "duration": 5, )" + members + "}";
        return run({"describe", "body.json"}).out;
    };
    const std::string sphere =
        described(R"("body": {"mass": 1, "inertia": [2, 2, 2]}, "initial": {"angular_velocity": [1, 2, 3]})");
    EXPECT_NE(sphere.find("3 variables"), std::string::npos) << sphere;
    EXPECT_NE(sphere.find("gyroscopic term w x Iw"), std::string::npos) << sphere;
    const std::string symmetric =
        described(R"("body": {"mass": 1, "inertia": [2, 2, 1]}, "initial": {"angular_velocity": [1, 2, 3]})");
    EXPECT_NE(symmetric.find("free rotation, 7 variables"), std::string::npos) << symmetric;
    EXPECT_NE(symmetric.find("spin about the axis of symmetry"), std::string::npos) << symmetric;
    const std::string loaded = described(
        R"("body": {"mass": 1, "inertia": [[2, 0.1, 0], [0.1, 2, 0], [0, 0, 3]]}, "loads": [{"type": "force",
           "vector": [1, 0, 0], "frame": "body", "point": [0, 1, 0], "from": 1, "until": 2}])");
    EXPECT_NE(loaded.find("loaded rotation and translation, 13 variables"), std::string::npos) << loaded;
    EXPECT_NE(loaded.find("products of inertia"), std::string::npos) << loaded;
    EXPECT_NE(loaded.find("1 s to 2 s"), std::string::npos) << loaded;
}

}  // namespace
}  // namespace polhode
