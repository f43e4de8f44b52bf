#include "convert.h"

namespace pluvia {

btVector3 vector(const std::array<double, 3> &v) {
    return btVector3(static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]),
                     static_cast<btScalar>(v[2]));
}

std::array<double, 3> array(const btVector3 &v) {
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

std::array<double, 4> array(const btQuaternion &q) {
    return {static_cast<double>(q.x()), static_cast<double>(q.y()), static_cast<double>(q.z()),
            static_cast<double>(q.w())};
}

btVector3 Units::length(const std::array<double, 3> &m) const {
    return vector({m[0] * scale_, m[1] * scale_, m[2] * scale_});
}

btVector3 Units::inertia(const std::array<double, 3> &i) const {
    const double s = scale_ * scale_;
    return vector({i[0] * s, i[1] * s, i[2] * s});
}

btTransform Units::pose(const std::array<double, 3> &metres,
                        const std::array<double, 4> &xyzw) const {
    btQuaternion rotation(static_cast<btScalar>(xyzw[0]), static_cast<btScalar>(xyzw[1]),
                          static_cast<btScalar>(xyzw[2]), static_cast<btScalar>(xyzw[3]));
    return btTransform(rotation, length(metres));
}

std::array<double, 3> Units::metres(const btVector3 &u) const {
    const auto a = array(u);
    return {a[0] / scale_, a[1] / scale_, a[2] / scale_};
}

} // namespace pluvia
