// Shapes of a body as Bullet's collision shapes.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "integrators/engines/drivers/bullet_joints.h"

namespace polhode::engines {

/// An ellipsoid by its support function. Bullet has no ellipsoid, but collides any shape with a support function.
class BulletEllipsoid : public btConvexInternalShape {
  public:
    explicit BulletEllipsoid(const btVector3& semi_axes) : semi_axes_(semi_axes) {
        m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
        m_collisionMargin = 0;
    }
    btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override {
        const btVector3 a = direction * semi_axes_;
        const btScalar length = a.length();
        return length > 0 ? a * semi_axes_ / length : btVector3(0, 0, 0);
    }
    btVector3 localGetSupportingVertex(const btVector3& direction) const override {
        return localGetSupportingVertexWithoutMargin(direction);
    }
    void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions, btVector3* vertices,
                                                           int count) const override {
        for (int i = 0; i < count; ++i) vertices[i] = localGetSupportingVertexWithoutMargin(directions[i]);
    }
    void getAabb(const btTransform& at, btVector3& low, btVector3& high) const override {
        const btVector3 reach(semi_axes_[semi_axes_.maxAxis()], semi_axes_[semi_axes_.maxAxis()],
                              semi_axes_[semi_axes_.maxAxis()]);
        low = at.getOrigin() - reach, high = at.getOrigin() + reach;
    }
    // the driver gives the moments of inertia
    void calculateLocalInertia(btScalar, btVector3& moments) const override { moments.setZero(); }
    const char* getName() const override { return "Ellipsoid"; }

  private:
    btVector3 semi_axes_;
};

/// Makes and owns the shapes of a body.
class BulletShapes {
  public:
    /// One shape, or a compound where shapes are placed elsewhere than at the origin. Without shapes, a ball.
    btCollisionShape* make(const std::vector<EngineShape>& shapes) {
        if (shapes.empty()) return own(std::make_unique<btSphereShape>(btScalar(1)));
        const EngineShape& first = shapes.front();
        const bool is_centered = squared_norm(first.q) == first.q.w * first.q.w && first.position == Vector3<double>();
        if (shapes.size() == 1 && (is_centered || first.type == "polyhedron" || first.is_centered_ball()))
            return own(convex(first));
        auto compound = std::make_unique<btCompoundShape>();
        for (const EngineShape& shape : shapes) {
            btTransform place = btTransform::getIdentity();
            if (shape.type != "polyhedron") place = btTransform(bullet(shape.q), bullet(shape.position));
            compound->addChildShape(place, own(convex(shape)));
        }
        return own(std::move(compound));
    }

  private:
    btCollisionShape* own(std::unique_ptr<btCollisionShape> shape) {
        shapes_.push_back(std::move(shape));
        return shapes_.back().get();
    }
    static std::unique_ptr<btCollisionShape> convex(const EngineShape& shape) {
        const btScalar radius = btScalar(shape.radius), half_height = btScalar(shape.half_height);
        if (shape.type == "ball") return std::make_unique<btSphereShape>(radius);
        if (shape.type == "capsule") return std::make_unique<btCapsuleShapeZ>(radius, 2 * half_height);
        if (shape.type == "cylinder" || shape.type == "disc") {
            const btScalar half = shape.type == "disc" ? btScalar(disc_half_height(shape)) : half_height;
            return std::make_unique<btCylinderShapeZ>(btVector3(radius, radius, half));
        }
        if (shape.type == "ellipsoid") return std::make_unique<BulletEllipsoid>(bullet(shape.half));
        if (shape.type == "box") return std::make_unique<btBoxShape>(bullet(shape.half));
        auto hull = std::make_unique<btConvexHullShape>();
        for (const auto& corner : shape.corners) hull->addPoint(bullet(corner), false);
        hull->recalcLocalAabb();
        return hull;
    }

    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
};

}  // namespace polhode::engines
