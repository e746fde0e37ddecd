// The convex hull of a body that has a shape.
#pragma once

#include <vector>

#include "body/support.h"
#include "scene/body_source.h"

namespace polhode {

/// Visits what a body is made of; holes add nothing, and a mass without a shape has no hull.
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
            for (const SupportPiece<S>& piece : std::visit(*this, part.body->made_of))
                pieces.push_back(placed(piece, cast<S>(part.position), q));
        }
        return pieces;
    }
    template <class Other>
    std::vector<SupportPiece<S>> operator()(const Other&) const {
        return {};  // a mass without a shape
    }
};

/// Pieces whose convex hull is the body's, from its own origin in its own axes.
template <class S>
std::vector<SupportPiece<S>> hull(const BodySource& source) {
    return std::visit(HullOf<S>{}, source.made_of);
}

}  // namespace polhode
