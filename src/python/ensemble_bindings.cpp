// Ensembles: from arrays to arrays.
#include <thread>

#include "integrators/own/mechanism_ensemble.h"
#include "motion/ensemble_table.h"
#include "motion/trajectory_columns.h"
#include "python/bindings.h"
#include "text/parallel.h"

namespace polhode::python {
namespace {

using Column = py::array_t<double, py::array::c_style | py::array::forcecast>;

struct SolvedBodies {
    std::vector<EnsembleRow> rows;
    std::vector<std::size_t> failed;  ///< indices of failed rows
    double seconds = 0;
};

// Values that differ from the scene's, as optional blocks with one row per body.
struct Columns {
    std::optional<Column> q, w, p, v, inertia, mass;
};

EnsembleSettings settings_of(std::optional<double> tolerance, int threads, long max_steps, double max_seconds) {
    EnsembleSettings settings;
    settings.tolerance = tolerance.value_or(settings.tolerance);
    settings.threads = threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    settings.max_steps = max_steps, settings.seconds_limit = max_seconds;
    return settings;
}

Vector3<double> vector_at(const double* row) { return {row[0], row[1], row[2]}; }

std::shared_ptr<SolvedBodies> solve_bodies(const ReadScene& read, std::size_t count, const Columns& columns,
                                           const EnsembleSettings& settings) {
    const auto data = [](const std::optional<Column>& column) { return column ? column->data() : nullptr; };
    const double *q = data(columns.q), *w = data(columns.w), *p = data(columns.p), *v = data(columns.v);
    const double *inertia = data(columns.inertia), *mass = data(columns.mass);
    const bool tensors = columns.inertia && columns.inertia->ndim() == 3;
    auto solved = std::make_shared<SolvedBodies>();
    call_in_thread([&] {
        const Stopwatch stopwatch;
        solved->rows.resize(count);
        const EnsembleBody alike = ensemble_body(read.scene());
        EnsembleSettings alone = settings;
        alone.threads = 1;
        // bodies are created in blocks that fit into the cache
        constexpr std::size_t block = 2048;
        std::vector<std::vector<std::size_t>> failed((count + block - 1) / block);
        parallel_for(failed.size(), settings.threads, [&](std::size_t part) {
            const std::size_t first = part * block, end = std::min(count, first + block);
            thread_local std::vector<EnsembleBody> bodies;  // reused by all blocks of a thread
            bodies.assign(end - first, alike);
            for (std::size_t i = first; i < end; ++i) {
                EnsembleBody& body = bodies[i - first];
                if (q) body.orientation = {q[4 * i], q[4 * i + 1], q[4 * i + 2], q[4 * i + 3]};
                if (w) body.angular_velocity = vector_at(w + 3 * i);
                if (p) body.position_W = vector_at(p + 3 * i);
                if (v) body.velocity_W = vector_at(v + 3 * i);
                if (mass) body.mass = mass[i];
                if (inertia && !tensors) body.inertia_B = diagonal(vector_at(inertia + 3 * i));
                if (tensors)
                    for (std::size_t k = 0; k < 3; ++k) body.inertia_B[k] = vector_at(inertia + 9 * i + 3 * k);
            }
            solve_ensemble(read.scene(), bodies, alone, std::span(solved->rows).subspan(first, end - first));
            for (std::size_t i = first; i < end; ++i)
                if (solved->rows[i].status != Status::ok) failed[part].push_back(i);
        });
        for (const auto& some : failed) solved->failed.insert(solved->failed.end(), some.begin(), some.end());
        solved->seconds = stopwatch.seconds();
        return true;
    });
    return solved;
}

// Solves a mechanism from a table of named columns, one initial state per row.
py::tuple solve_mechanisms(const ReadScene& read, const std::string& table_text, long samples,
                           const EnsembleSettings& settings) {
    std::vector<MechanismRow> rows;
    EnsembleTable table;
    call_in_thread([&] {
        table = parse_ensemble(table_text, "the arrays", read.scene(), BadRows::pass_over);
        rows = solve_mechanism_ensemble(read.scene(), table.mechanisms, samples, settings);
        return true;
    });
    const std::size_t count = table.rows() + table.refused.size();
    const std::vector<std::size_t> row_numbers = table.row_numbers(1);
    const std::size_t per_row = static_cast<std::size_t>(samples) * read.scene().bodies.size();
    constexpr std::size_t width = std::size(motion_columns);
    std::vector<double> numbers(count * per_row * width, std::numeric_limits<double>::quiet_NaN());
    std::vector<std::string> statuses(count, name_of(Status::failed)), messages(count);
    for (const RefusedRow& refused : table.refused) messages[refused.row - 1] = refused.fault;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const std::size_t row = row_numbers[k] - 1;
        statuses[row] = name_of(rows[k].status), messages[row] = rows[k].message;
        auto number = numbers.begin() + static_cast<std::ptrdiff_t>(row * per_row * width);
        for (const Sample& sample : rows[k].samples) number = std::ranges::copy(motion_numbers(sample), number).out;
    }
    const auto n = static_cast<py::ssize_t>(count);
    return py::make_tuple(
        take(std::move(numbers), {n, samples, static_cast<py::ssize_t>(read.scene().bodies.size()), width}), statuses,
        messages);
}

template <class Member>
auto block(py::ssize_t length, Member member) {
    return py::cpp_function([length, member](const py::object& self) {
        const SolvedBodies& solved = self.cast<const SolvedBodies&>();
        static const EnsembleRow nothing{};
        const EnsembleRow& first = solved.rows.empty() ? nothing : solved.rows.front();
        return view(member(first), {static_cast<py::ssize_t>(solved.rows.size()), length},
                    {static_cast<py::ssize_t>(sizeof(EnsembleRow)), static_cast<py::ssize_t>(sizeof(double))}, self);
    });
}

}  // namespace

void bind_ensembles(py::module_& module) {
    py::class_<EnsembleSettings>(module, "EnsembleSettings").def(py::init(&settings_of));
    py::class_<Columns>(module, "Columns")
        .def(py::init([](std::optional<Column> q, std::optional<Column> w, std::optional<Column> p,
                         std::optional<Column> v, std::optional<Column> inertia, std::optional<Column> mass) {
            return Columns{std::move(q), std::move(w), std::move(p), std::move(v), std::move(inertia), std::move(mass)};
        }));
    py::class_<SolvedBodies, std::shared_ptr<SolvedBodies>>(module, "SolvedBodies")
        .def_property_readonly("q", block(4, [](const EnsembleRow& row) { return &row.end.q.w; }))
        .def_property_readonly(
            "w_B", block(3, [](const EnsembleRow& row) { return row.end.angular_velocity_B.component.data(); }))
        .def_property_readonly("p",
                               block(3, [](const EnsembleRow& row) { return row.end.position_W.component.data(); }))
        .def_property_readonly("v",
                               block(3, [](const EnsembleRow& row) { return row.end.velocity_W.component.data(); }))
        .def_readonly("seconds", &SolvedBodies::seconds)
        .def("__len__", [](const SolvedBodies& solved) { return solved.rows.size(); })
        .def("w",
             [](const SolvedBodies& solved) {
                 std::vector<double> rates;
                 rates.reserve(3 * solved.rows.size());
                 for (const EnsembleRow& row : solved.rows) {
                     const Vector3<double> w = angular_velocity_W(row.end);
                     rates.insert(rates.end(), {w[0], w[1], w[2]});
                 }
                 return take(std::move(rates), {static_cast<py::ssize_t>(solved.rows.size()), 3});
             })
        .def("failures", [](const SolvedBodies& solved) {
            py::list all;
            for (const std::size_t i : solved.failed)
                all.append(py::make_tuple(i, name_of(solved.rows[i].status), solved.rows[i].message));
            return all;
        });
    module.def("solve_bodies", &solve_bodies);
    module.def("solve_mechanisms", &solve_mechanisms);
}

}  // namespace polhode::python
