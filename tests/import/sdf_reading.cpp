// Prints the poses of links and joints in SDFormat files, as libsdformat computes them, as JSON lines. sdf_to_mjcf.py
// is compared with these poses by `compute --check-sdf`.
#include <cstdio>
#include <iostream>
#include <sdf/sdf.hh>
#include <string>

using ignition::math::Pose3d;
using ignition::math::Vector3d;

namespace {

std::string separator;

void print_vector(const char* name, const Vector3d& v) {
    std::printf("\"%s\":[%.17g,%.17g,%.17g]", name, v.X(), v.Y(), v.Z());
}

void print_pose(const Pose3d& pose) {
    print_vector("position", pose.Pos());
    std::printf(",\"attitude\":[%.17g,%.17g,%.17g,%.17g]", pose.Rot().W(), pose.Rot().X(), pose.Rot().Y(),
                pose.Rot().Z());
}

void print_errors(const sdf::Errors& errors) {
    for (const sdf::Error& error : errors) std::cerr << error.Message() << '\n';
}

void print_link(const sdf::Link& link, const std::string& scope, const Pose3d& model_in_world) {
    Pose3d pose;
    print_errors(link.SemanticPose().Resolve(pose, "__model__"));
    const auto& inertial = link.Inertial();
    const ignition::math::Matrix3d tensor = inertial.Moi();
    std::printf("%s{\"kind\":\"link\",\"name\":\"%s\",", separator.c_str(), (scope + link.Name()).c_str());
    print_pose(model_in_world * pose);
    std::printf(",\"mass\":%.17g,", inertial.MassMatrix().Mass());
    print_vector("center", inertial.Pose().Pos());
    std::printf(",\"tensor\":[");
    for (int i = 0; i < 9; ++i) std::printf("%s%.17g", i ? "," : "", tensor(i / 3, i % 3));
    std::printf("]}");
    separator = ",";
}

void print_joint(const sdf::Joint& joint, const std::string& scope) {
    std::string parent, child;
    print_errors(joint.ResolveParentLink(parent));
    print_errors(joint.ResolveChildLink(child));
    Pose3d in_child;
    print_errors(joint.SemanticPose().Resolve(in_child, child));
    std::printf("%s{\"kind\":\"joint\",\"name\":\"%s\",\"parent\":\"%s\",\"child\":\"%s\",", separator.c_str(),
                (scope + joint.Name()).c_str(), parent == "world" ? "world" : (scope + parent).c_str(),
                (scope + child).c_str());
    print_vector("point", in_child.Pos());
    std::printf(",\"axes\":[");
    for (int i = 0; i < 2; ++i) {
        const sdf::JointAxis* axis = joint.Axis(i);
        if (!axis) continue;
        Vector3d v;
        print_errors(axis->ResolveXyz(v, child));
        std::printf("%s{", i ? "," : "");
        print_vector("axis", v);
        std::printf(",\"damping\":%.17g,\"stiffness\":%.17g,\"springref\":%.17g}", axis->Damping(),
                    axis->SpringStiffness(), axis->SpringReference());
    }
    std::printf("]}");
    separator = ",";
}

void print_model(const sdf::Model& model, const std::string& outer, const Pose3d& outer_in_world, bool is_root) {
    Pose3d pose;
    print_errors(is_root ? model.SemanticPose().Resolve(pose, "__root__") : model.SemanticPose().Resolve(pose));
    if (is_root && pose == Pose3d::Zero) pose = model.RawPose();
    const Pose3d in_world = outer_in_world * pose;
    const std::string scope = outer + model.Name() + "::";
    for (std::uint64_t i = 0; i < model.LinkCount(); ++i) print_link(*model.LinkByIndex(i), scope, in_world);
    for (std::uint64_t i = 0; i < model.JointCount(); ++i) print_joint(*model.JointByIndex(i), scope);
    for (std::uint64_t i = 0; i < model.ModelCount(); ++i) print_model(*model.ModelByIndex(i), scope, in_world, false);
}

}  // namespace

int main(int count, char** arguments) {
    if (count == 2 && std::string(arguments[1]) == "version") {
        std::cout << SDF_VERSION << ", libsdformat " << SDF_VERSION_FULL << '\n';
        return 0;
    }
    sdf::ParserConfig config;
    for (int i = 2; i < count; ++i) {
        const std::string file = arguments[i], folder = arguments[1];
        // resolve model:// and relative URIs in the same folder
        config.SetFindCallback([folder](const std::string& uri) {
            return folder + "/" + uri.substr(uri.find("://") == uri.npos ? 0 : uri.find("://") + 3);
        });
        sdf::Root root;
        const sdf::Errors errors = root.Load(file, config);
        std::printf("{\"file\":\"%s\",\"errors\":%zu,\"parts\":[", file.substr(file.rfind('/') + 1).c_str(),
                    errors.size());
        print_errors(errors);
        separator.clear();
        if (const sdf::Model* model = root.Model()) print_model(*model, "", Pose3d::Zero, true);
        for (std::uint64_t w = 0; w < root.WorldCount(); ++w)
            for (std::uint64_t m = 0; m < root.WorldByIndex(w)->ModelCount(); ++m)
                print_model(*root.WorldByIndex(w)->ModelByIndex(m), "", Pose3d::Zero, false);
        std::printf("]}\n");
    }
}
