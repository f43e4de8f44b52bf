// Grains between planes and fixed pieces: what the referee pours and measures.
#pragma once

#include "hull.h"

#include <array>
#include <string>

namespace referee {

enum class Material { Grain, Wall, Plate };

struct Grain {
    Hull hull; // about the centre of mass, along the principal axes
    Material material = Material::Grain;
    double mass = 0;
    Vec3 inertia;
    Vec3 position;
    Quat rotation;
    Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
};

struct Piece {
    Hull hull;
    Vec3 position;
    Quat rotation;
};

struct Scene {
    std::vector<Grain> grains;
    std::vector<Plane> walls;
    std::vector<Piece> pieces; // fixed, of the material of walls
    Vec3 gravity{0, 0, -9.81};
    std::array<std::array<double, 3>, 3> friction{}; // by material
    double restitution = 0;
    double restitution_threshold = 0;   // approach below which nothing rebounds, m/s
    double closed_gap = 0, met_gap = 0; // of the rule of impacts (restitution.h), m

    void set_friction(double of_all);
};

// A contact point between grain `a` and grain `b`; or what is fixed, if b < 0:
// wall −1 − b, the pieces after the walls.
struct SceneTouch {
    int a, b;
    Touch touch;
};

// Reads a scene of docs/exchange.md. Beside it: `walls_m`, planes as [nx, ny, nz,
// offset]; `restitution_threshold_m_per_s`, `closed_gap_m`, `met_gap_m`.
Scene read_scene(const std::string &text);

// All contact points with gaps up to the sum of the two bodies' margins; what is
// fixed has none. `doubt` as in hull.h.
std::vector<SceneTouch> scene_touches(const Scene &scene, const std::vector<double> &margins,
                                      double doubt = 0);

double friction_of(const Scene &scene, const SceneTouch &touch);

// What is measured of a packing, whoever made it.
struct Packing {
    double mean_height = 0;     // of the centroids, m
    double coordination = 0;    // grains that a grain touches
    double deepest_overlap = 0; // along the axis of largest separation, m
    int outside = 0;            // grains whose centre is behind a wall
};
Packing measure(const Scene &scene, double touching_gap);

} // namespace referee
