// Between Pluvia's SI units in double precision and the engine's own units.
//
// Lengths are multiplied by a scale; mass and time are not touched. So velocities and gravity scale
// like lengths, moments of inertia like lengths squared, impulses like lengths.
#pragma once

#include "three.h"

#include <LinearMath/btTransform.h>

#include <array>

namespace pluvia {

inline Vec three(const btVector3 &v) {
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}
inline btVector3 vector(const Vec &v) {
    return btVector3(static_cast<btScalar>(v.x), static_cast<btScalar>(v.y),
                     static_cast<btScalar>(v.z));
}
inline std::array<double, 3> array(const Vec &v) { return {v.x, v.y, v.z}; }
inline std::array<double, 3> array(const btVector3 &v) { return array(three(v)); }

// Components in the order x, y, z, w.
inline std::array<double, 4> array(const btQuaternion &q) {
    return {static_cast<double>(q.x()), static_cast<double>(q.y()), static_cast<double>(q.z()),
            static_cast<double>(q.w())};
}

class Units {
  public:
    explicit Units(double engine_units_per_metre) : scale_(engine_units_per_metre) {}

    double scale() const { return scale_; }

    btScalar length(double metres) const { return static_cast<btScalar>(metres * scale_); }
    btVector3 length(const std::array<double, 3> &metres) const {
        return vector(three(metres.data()) * scale_);
    }
    btVector3 inertia(const std::array<double, 3> &kg_m2) const {
        return vector(three(kg_m2.data()) * (scale_ * scale_));
    }
    // Of whatever has a position and a rotation.
    template <class Placed> btTransform pose(const Placed &of) const {
        const auto &q = of.rotation; // x, y, z, w
        return btTransform(btQuaternion(static_cast<btScalar>(q[0]), static_cast<btScalar>(q[1]),
                                        static_cast<btScalar>(q[2]), static_cast<btScalar>(q[3])),
                           length(of.position));
    }

    double metres(double units) const { return units / scale_; }
    std::array<double, 3> metres(const btVector3 &units) const { return metres(three(units)); }
    std::array<double, 3> metres(const Vec &units) const { return array(units / scale_); }

  private:
    double scale_;
};

} // namespace pluvia
