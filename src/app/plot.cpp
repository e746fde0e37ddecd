// polhode plot: plots trajectories on the terminal or as files. Without a scene it plots components over time, with
// --scene errors against the truth, or the polhode on the inertia ellipsoid. gnuplot draws SVG and PDF files.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/polhode_picture.h"
#include "check/check_files.h"
#include "check/error_over_time.h"
#include "figure/character_plot.h"
#include "figure/curve_style.h"
#include "figure/gnuplot.h"
#include "figure/thinned.h"
#include "measure/measures.h"
#include "motion/problem.h"
#include "scene/scene_file.h"
#include "text/json_document.h"
#include "text/message.h"
#include "text/terminal.h"

namespace polhode {
namespace {

struct PlotOptions {
    std::vector<std::string> files;
    std::string scene, of = "attitude", convention, columns, output;
    int width = 0;
};

/// A trajectory file to plot.
struct PlottedFile {
    std::string name;  ///< label in the legend
    std::string path;
    TrajectoryFile file;
    std::vector<std::size_t> gaps;  ///< indices of times that follow rows with NaN

    std::size_t moments() const { return file.rows.size() / file.bodies_at_once(); }
};

// Returns the file names if they are distinct, otherwise the paths.
std::vector<std::string> names_of(const std::vector<std::string>& paths) {
    std::vector<std::string> names;
    for (const std::string& path : paths) names.push_back(std::filesystem::path(path).filename().string());
    const bool distinct = std::set<std::string>(names.begin(), names.end()).size() == names.size();
    for (std::size_t i = 0; i < paths.size(); ++i) names[i] = one_line(distinct ? names[i] : paths[i], 60);
    return names;
}

std::vector<PlottedFile> read_files(const PlotOptions& options, const Scene* scene, const Convention& convention) {
    ColumnNames columns;
    if (!options.columns.empty()) columns = as_usage([&] { return parse_columns(options.columns); }, "--columns: ");
    columns.degrees = convention.degrees;
    const std::vector<std::string> names = names_of(options.files);
    std::vector<PlottedFile> files;
    for (std::size_t i = 0; i < options.files.size(); ++i) {
        PlottedFile& one = files.emplace_back();
        one.name = names[i], one.path = options.files[i];
        CheckedFile checked;
        checked.path = one.path;
        one.file = prepare_file(scene, convention, columns, read_text(one.path, largest_file, "a readable CSV file"),
                                checked, &one.gaps);
    }
    return files;
}

// Adds a curve over time in pieces between gaps, thinned to `columns` columns.
void add_pieces(Panel& panel, const Curve& whole, const std::vector<std::size_t>& gaps, std::size_t columns) {
    std::vector<std::size_t> edges = gaps;
    edges.push_back(whole.x.size());
    std::size_t begin = 0;
    for (const std::size_t edge : edges) {
        const std::size_t end = std::min(edge, whole.x.size());
        if (end <= begin) continue;
        Curve piece = whole;
        piece.x.assign(whole.x.begin() + static_cast<std::ptrdiff_t>(begin),
                       whole.x.begin() + static_cast<std::ptrdiff_t>(end));
        piece.y.assign(whole.y.begin() + static_cast<std::ptrdiff_t>(begin),
                       whole.y.begin() + static_cast<std::ptrdiff_t>(end));
        thin(piece, columns);
        panel.curves.push_back(std::move(piece));
        begin = end;
    }
}

Curve find_or_add_plot_curve(const std::string& label, std::size_t place) {
    Curve curve;
    curve.label = label, curve.points = false;
    // dashes differ, so that curves remain visible where files agree
    curve.dash = static_cast<int>(place % 5);
    set_style(curve, plain_style(static_cast<int>(place)));
    return curve;
}

Panel panel_over_time(const std::string& title, const std::string& y_label, bool logarithmic) {
    Panel panel;
    panel.title = title, panel.x_label = "time (s)", panel.y_label = y_label;
    panel.log_x = false, panel.log_y = logarithmic;
    return panel;
}

/// The components that are plotted without a scene.
struct Components {
    std::string title;
    std::string y_label;
    std::vector<std::string> names;
    std::vector<double> (*of)(const TrajectoryRow&);
};

std::vector<double> three(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }
Vector3<double> rate_in_body(const TrajectoryRow& row) {
    return rotate_back(normalized(row.q), row.angular_velocity_W);
}

Components components_of(const std::string& quantity, const Convention& convention) {
    if (quantity == "attitude")
        return {"attitude, body to world", "", {"qw", "qx", "qy", "qz"}, [](const TrajectoryRow& row) {
                    return std::vector{row.q.w, row.q.x, row.q.y, row.q.z};
                }};
    if (quantity == "polhode" || convention.body_rates)
        return {"angular velocity, body axes", "rad/s", {"wx", "wy", "wz"}, [](const TrajectoryRow& row) {
                    return three(rate_in_body(row));
                }};
    return {"angular velocity, world axes", "rad/s", {"wx", "wy", "wz"}, [](const TrajectoryRow& row) {
                return three(row.angular_velocity_W);
            }};
}

void require_rates(const PlottedFile& one, const std::string& quantity) {
    if (one.file.has_angular_velocity) return;
    throw InputError(one.path, "", fmt::format("has no wx,wy,wz, which --of {} requires", quantity),
                     "add these columns, or use --of attitude");
}

Figure figure_of_components(const std::vector<PlottedFile>& files, const std::string& quantity,
                            const Convention& convention, std::size_t columns) {
    const Components components = components_of(quantity, convention);
    Figure figure;
    figure.title = components.title;
    figure.columns = components.names.size() == 4 ? 2 : 1;
    for (const std::string& name : components.names)
        figure.panels.push_back(panel_over_time(name, components.y_label, false));
    std::size_t place = 0;
    for (const PlottedFile& one : files) {
        if (quantity != "attitude") require_rates(one, quantity);
        const std::size_t at_once = one.file.bodies_at_once();
        for (std::size_t body = 0; body < at_once; ++body, ++place) {
            std::vector<Curve> curves(components.names.size(), find_or_add_plot_curve(one.name, place));
            for (std::size_t k = body; k < one.file.rows.size(); k += at_once) {
                const TrajectoryRow& row = one.file.rows[k];
                const std::vector<double> values = components.of(row);
                for (std::size_t i = 0; i < values.size(); ++i)
                    curves[i].x.push_back(row.t), curves[i].y.push_back(values[i]);
            }
            for (std::size_t i = 0; i < curves.size(); ++i) {
                if (at_once > 1) curves[i].label += ", " + one_line(one.file.bodies[body], 40);
                add_pieces(figure.panels[i], curves[i], one.gaps, columns);
            }
        }
    }
    return figure;
}

// Throws TruthUnavailable.
Figure figure_of_errors(const std::vector<PlottedFile>& files, const Scene& scene, const std::string& quantity,
                        std::size_t columns) {
    const Measure& measure = measures()[measure_index(quantity)];
    Figure figure;
    figure.title = fmt::format("{} on {}", files.size() == 1 ? files.front().name : "trajectories", scene.name);
    figure.panels.push_back(
        panel_over_time(std::string(measure.title),
                        fmt::format("{}error{}", body_count(scene) > 1 && measure.error ? "worst body's " : "",
                                    measure.unit.empty() ? "" : fmt::format(" ({})", measure.unit)),
                        true));
    for (std::size_t i = 0; i < files.size(); ++i) {
        const PlottedFile& one = files[i];
        const ErrorOverTime errors = error_over_time(scene, one.file, quantity, one.path);
        if (!errors.fault.empty()) throw TruthUnavailable(one.path + ": " + errors.fault);
        Curve curve = find_or_add_plot_curve(one.name, i);
        curve.x = errors.t, curve.y = errors.error;
        // there may be errors at fewer times than in the file
        std::vector<std::size_t> gaps;
        for (const std::size_t gap : one.gaps) {
            const double after = one.file.rows[gap * one.file.bodies_at_once()].t;
            gaps.push_back(static_cast<std::size_t>(std::ranges::lower_bound(curve.x, after) - curve.x.begin()));
        }
        add_pieces(figure.panels.front(), curve, gaps, columns);
    }
    return figure;
}

// The angular velocities of the file on the inertia ellipsoid of their initial energy.
PolhodeCurve make_polhode(const PlottedFile& one, const Scene& scene) {
    const Problem problem = pose(scene);
    PolhodeCurve polhode;
    const Vector3<double>& moments = polhode.moments = problem.body.principal.moments;
    const Quaternion<double>& q_BP = problem.body.principal.q_BP;
    polhode.body_axes = q_BP == Quaternion<double>{};
    polhode.until = one.file.rows.back().t;
    double largest = 0;
    for (std::size_t k = 0; k < one.file.rows.size(); ++k) {
        if (k == 0 || std::ranges::binary_search(one.gaps, k)) polhode.curve.emplace_back();
        const Vector3<double> w = rotate_back(q_BP, rate_in_body(one.file.rows[k]));
        polhode.curve.back().push_back(w);
        const double energy = (moments[0] * w[0] * w[0] + moments[1] * w[1] * w[1] + moments[2] * w[2] * w[2]) / 2;
        if (k == 0) polhode.energy = energy;
        largest = std::max(largest, energy);
    }
    polhode.energy_of_start = polhode.energy > 0;
    if (!polhode.energy_of_start) polhode.energy = largest;
    if (!(polhode.energy > 0)) {
        polhode.fault = "the body does not rotate";
        return polhode;
    }
    for (int i = 0; i < 3; ++i) polhode.semi_axes[i] = std::sqrt(2 * polhode.energy / moments[i]);
    for (Polyline& line : polhode.curve) line = simplify(line, polhode.semi_axes, 1e-3);
    return polhode;
}

int print_plot_error(const std::string& fault) {
    std::fputs(("polhode: " + one_line(fault, 500) + "\n").c_str(), stderr);
    return 1;
}

int plot_polhode(const PlotOptions& options, const std::vector<PlottedFile>& files, const Scene& scene) {
    require_rates(files.front(), "polhode");
    const PolhodeCurve polhode = make_polhode(files.front(), scene);
    if (!polhode.fault.empty()) return print_plot_error("cannot draw the picture: " + polhode.fault);
    const std::string title = fmt::format("{} on {}", files.front().name, scene.name);
    if (!options.output.empty()) {
        const std::string fault = draw_polhode(polhode, title, options.output);
        return fault.empty() ? 0 : print_plot_error("cannot draw the picture: " + fault);
    }
    std::string text = title + "\n";
    for (const std::string& line : polhode_text(polhode)) text += line + "\n";
    write_output("", text);
    return 0;
}

void require_sense(const PlotOptions& options) {
    const bool svg = options.output.ends_with(".svg"), pdf = options.output.ends_with(".pdf");
    if (!options.output.empty() && !svg && !pdf)
        throw UsageError(
            fmt::format("--output is {}; give a name that ends in .svg or .pdf", one_line(options.output, 200)));
    if (options.width != 0 && !options.output.empty())
        throw UsageError("--width applies to character plots only; remove --width or --output");
    if (options.width != 0 && (options.width < 40 || options.width > 1000))
        throw UsageError(fmt::format("--width is {}; give 40 to 1000", options.width));
    if (options.scene.empty() && (options.of == "energy" || options.of == "momentum"))
        throw UsageError(
            fmt::format("--of {} is computed from the body's inertia and loads; give --scene", options.of));
    if (!options.scene.empty() && options.of == "polhode" && options.files.size() > 1)
        throw UsageError("--of polhode draws one file on a scene's ellipsoid; give one file, or remove --scene");
    require_output(options.output);
}

int plot_command(const PlotOptions& options) {
    require_sense(options);
    const Convention convention = parse_convention_option(options.convention);
    std::optional<Scene> scene;
    if (!options.scene.empty()) scene = find_scene(options.scene);
    if (scene && options.of == "polhode") require_one_body(*scene, "--of polhode", "a polhode is drawn for one body");
    const std::vector<PlottedFile> files = read_files(options, scene ? &*scene : nullptr, convention);
    if (scene && options.of == "polhode") return plot_polhode(options, files, *scene);

    const int width = options.width != 0 ? options.width : std::max(40, terminal_width(1, 100));
    // a panel of a printed figure is about 200 points wide, and a printer resolves eight dots per point
    const std::size_t columns = options.output.empty() ? 2 * static_cast<std::size_t>(width) : 1600;
    Figure figure;
    try {
        figure = scene ? figure_of_errors(files, *scene, options.of, columns)
                       : figure_of_components(files, options.of, convention, columns);
    } catch (const TruthUnavailable& fault) {
        return print_plot_error(fault.what());
    }
    if (options.output.empty()) {
        const int rows = figure.panels.size() > 1 ? 8 : 20;
        write_output("", character_plot(figure, {width, rows, wants_color(1)}));
        return 0;
    }
    const std::string terminal = options.output.substr(options.output.size() - 3);
    const GnuplotRun run = gnuplot_picture(gnuplot_script(figure, terminal, ""), terminal, std::chrono::seconds(60));
    if (!run.fault.empty()) return print_plot_error("cannot draw the picture: " + run.fault);
    write_output(options.output, run.output);
    return 0;
}

}  // namespace

void add_plot(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "plot", "Plots trajectory files, or with --scene their errors, on the terminal or as SVG or PDF.");
    describe_columns(*command,
                     "Examples:\n"
                     "  polhode plot mine.csv --of omega\n"
                     "  polhode plot a.csv b.csv --scene lagrange_top --output errors.svg\n");
    const auto options = std::make_shared<PlotOptions>();
    command
        ->add_option("TRAJECTORY", options->files,
                     "CSV files as read by polhode check. A row with NaN is drawn as a gap")
        ->required();
    command->add_option("--scene", options->scene,
                        "Draw the errors against the truth of this scene (built-in name or file)");
    command
        ->add_option("--of", options->of,
                     "Quantity: attitude, omega, energy or momentum (both only with --scene), or polhode: angular "
                     "velocity in body axes, with --scene on the inertia ellipsoid")
        ->check(CLI::IsMember({"attitude", "omega", "energy", "momentum", "polhode"}))
        ->capture_default_str();
    command->add_option("--convention", options->convention, "Convention of the files (see polhode check --help)");
    command->add_option("--columns", options->columns, "Map of blocks to column names (see polhode check --help)");
    command->add_option("--output", options->output,
                        "Output file F.svg or F.pdf, drawn by gnuplot (default: characters on stdout)");
    command->add_option("--width", options->width,
                        "Width of the character plot, 40 to 1000 columns (default: the terminal's, or 100)");
    add_outside_option(*command);
    command->callback([options, &exit_code] { exit_code = plot_command(*options); });
}

}  // namespace polhode
