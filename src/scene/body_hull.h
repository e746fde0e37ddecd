// The convex hull of a body with a shape.
#pragma once

#include <vector>

#include "body/support.h"
#include "scene/body_source.h"

namespace polhode {

/// Visits a body's description. Holes are skipped; a mass without a shape has no hull.
template <class S>
struct HullOf {
    std::vector<SupportPiece<S>> operator()(const ShapedBody& body) const {
        if (body.amount.value < 0) return {};  // a hole
        return support<S>(body.shape);
    }
    std::vector<SupportPiece<S>> operator()(const MeshBody& body) const {
        if (body.amount.value < 0) return {};
        return support<S>(body.mesh);
    }
    std::vector<SupportPiece<S>> operator()(const PartsBody& body) const {
        std::vector<SupportPiece<S>> pieces;
        for (const PartsBody::Part& part : body.parts) {
            const Quaternion<S> q = normalized(cast<S>(part.orientation));
            for (const SupportPiece<S>& piece : std::visit(*this, part.body->definition))
                pieces.push_back(placed(piece, cast<S>(part.position), q));
        }
        return pieces;
    }
    template <class Other>
    std::vector<SupportPiece<S>> operator()(const Other&) const {
        return {};  // a mass without a shape
    }
};

/// Pieces whose convex hull is that of the body, in its own axes from its origin (m).
template <class S>
std::vector<SupportPiece<S>> hull(const BodySource& source) {
    return std::visit(HullOf<S>{}, source.definition);
}

}  // namespace polhode
