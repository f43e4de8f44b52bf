// Between Pluvia's SI units in double precision and the engine's own units.
//
// Lengths are multiplied by a scale; mass and time are not touched. So
// velocities and gravity scale like lengths, moments of inertia like lengths
// squared, impulses like lengths.
#pragma once

#include <LinearMath/btTransform.h>

#include <array>

namespace pluvia {

class Units {
  public:
    explicit Units(double engine_units_per_metre) : scale_(engine_units_per_metre) {}

    double scale() const { return scale_; }

    btScalar length(double metres) const { return static_cast<btScalar>(metres * scale_); }
    btVector3 length(const std::array<double, 3> &metres) const;
    btVector3 inertia(const std::array<double, 3> &kg_m2) const;
    btTransform pose(const std::array<double, 3> &metres, const std::array<double, 4> &xyzw) const;

    double metres(btScalar units) const { return static_cast<double>(units) / scale_; }
    std::array<double, 3> metres(const btVector3 &units) const;

  private:
    double scale_;
};

btVector3 vector(const std::array<double, 3> &v);
std::array<double, 3> array(const btVector3 &v);
// Quaternion components in the order x, y, z, w.
std::array<double, 4> array(const btQuaternion &q);

} // namespace pluvia
