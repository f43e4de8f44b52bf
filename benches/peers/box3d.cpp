// Box3D: a scene in a b3World, with the settings that docs/peers.md gives reasons for.
//
//   box3d THREADS SCENE.json RESULT.json RATE_HZ SUB_STEPS SECONDS LIMIT_S
#include "peer.h"

#include <box3d/box3d.h>

namespace {

// Box3D's tolerances are absolute and made for bodies of about one unit.
constexpr double SCALE = 100;

// A contact's frequency is limited to this share of the sub-steps a second
// (physics_world.c, where contactSoftness is made, 0.1.0).
constexpr double CLAMP = 0.125;

float unit(double value) { return static_cast<float>(value); }

b3Vec3 vector(const json::Value &v, double scale = SCALE) {
    return {unit(scale * v.at(0)), unit(scale * v.at(1)), unit(scale * v.at(2))};
}

b3Quat turn(const json::Value &q) {
    double square = 0;
    for (int i = 0; i < 4; ++i) {
        square += q.at(i) * q.at(i);
    }
    const double length = std::sqrt(square);
    return {{unit(q.at(0) / length), unit(q.at(1) / length), unit(q.at(2) / length)},
            unit(q.at(3) / length)};
}

b3WorldDef world_definition(const peer::Job &job, int threads) {
    b3WorldDef definition = b3DefaultWorldDef();
    definition.gravity = vector(job.scene["gravity_m_per_s2"]);
    definition.contactHertz = unit(CLAMP * job.rate * job.iterations);
    definition.enableSleep = false;
    definition.enableContinuous = false;
    definition.workerCount = static_cast<std::uint32_t>(threads);
    return definition;
}

class Laboratory {
  public:
    Laboratory(const peer::Job &job, int threads)
        : substeps_(job.iterations), middle_(job.scene["table"]["x_m"].number) {
        const b3WorldDef definition = world_definition(job, threads);
        world_ = b3CreateWorld(&definition);
        build(job.scene);
    }
    ~Laboratory() { b3DestroyWorld(world_); }
    Laboratory(const Laboratory &) = delete;
    Laboratory &operator=(const Laboratory &) = delete;

    void drive(double x, double step) {
        for (const OnTable &piece : on_table_) {
            b3Transform end = piece.at;
            end.p.x += unit(SCALE * (x - middle_));
            b3Body_SetTargetTransform(piece.body, end, unit(step), true);
        }
    }

    void step(double length) { b3World_Step(world_, unit(length), substeps_); }

    std::vector<peer::Pose> poses() const {
        std::vector<peer::Pose> out;
        for (const b3BodyId &grain : grains_) {
            const b3Transform at = b3Body_GetTransform(grain);
            out.push_back({{at.p.x / SCALE, at.p.y / SCALE, at.p.z / SCALE},
                           {at.q.v.x, at.q.v.y, at.q.v.z, at.q.s}});
        }
        return out;
    }

  private:
    struct OnTable {
        b3BodyId body;
        b3Transform at; // where the table is at the beginning
    };
    b3WorldId world_;
    int substeps_;
    double middle_;
    std::vector<b3BodyId> grains_;
    std::vector<OnTable> on_table_;

    // Box3D combines what two bodies have by rules that agree for equal values alone.
    static b3ShapeDef surface(const json::Value &scene) {
        b3ShapeDef definition = b3DefaultShapeDef();
        const json::Value &first = scene["pairs"].list.at(0);
        for (const json::Value &pair : scene["pairs"].list) {
            if (pair["friction"].number != first["friction"].number ||
                pair["restitution"].number != first["restitution"].number) {
                throw std::runtime_error("pairs: their values differ, allowed is one for all");
            }
        }
        definition.baseMaterial.friction = unit(first["friction"].number);
        definition.baseMaterial.restitution = unit(first["restitution"].number);
        return definition;
    }

    static b3HullData *create_hull(const std::vector<b3Vec3> &points) {
        return b3CreateHull(points.data(), static_cast<int>(points.size()), B3_MAX_HULL_VERTICES);
    }

    static std::vector<b3Vec3> corners(const b3AABB &box) {
        std::vector<b3Vec3> out;
        for (int i = 0; i < 8; ++i) {
            const auto side = [i](int axis, float low, float high) {
                return (i >> axis & 1) != 0 ? high : low;
            };
            out.push_back({side(0, box.lowerBound.x, box.upperBound.x),
                           side(1, box.lowerBound.y, box.upperBound.y),
                           side(2, box.lowerBound.z, box.upperBound.z)});
        }
        return out;
    }

    b3BodyId add(const json::Value &what, b3BodyType type, const b3ShapeDef &surface) {
        b3BodyDef definition = b3DefaultBodyDef();
        definition.type = type;
        definition.position = vector(what["position_m"]);
        definition.rotation = turn(what["quaternion_xyzw"]);
        if (type == b3_dynamicBody) {
            definition.linearVelocity = vector(what["linear_velocity_m_per_s"]);
            definition.angularVelocity = vector(what["angular_velocity_rad_per_s"], 1);
        }
        const b3BodyId body = b3CreateBody(world_, &definition);
        std::vector<b3Vec3> points;
        for (const json::Value &v : what["vertices_m"].list) {
            points.push_back(vector(v));
        }
        b3HullData *hull = create_hull(points);
        if (hull == nullptr && type != b3_dynamicBody && what["name"].text == "floor") {
            // More edges than Box3D takes. Only the walls stand on what its box has beyond it.
            hull =
                create_hull(corners(b3MakeAABB(points.data(), static_cast<int>(points.size()), 0)));
        }
        if (hull == nullptr) {
            throw std::runtime_error("Box3D makes no hull of " + std::to_string(points.size()) +
                                     " vertices");
        }
        b3CreateHullShape(body, &surface, hull);
        b3DestroyHull(hull); // the shape has its own
        return body;
    }

    void build(const json::Value &scene) {
        if (!scene["top_plate"].null()) {
            throw std::runtime_error("top_plate: this peer has none, allowed is null");
        }
        const b3ShapeDef surface = Laboratory::surface(scene);
        for (const json::Value &piece : scene["apparatus"].list) {
            const bool moves = piece["motion"].text == "table";
            const b3BodyId body = add(piece, moves ? b3_kinematicBody : b3_staticBody, surface);
            if (moves) {
                on_table_.push_back({body, b3Body_GetTransform(body)});
            }
        }
        for (const json::Value &grain : scene["grains"].list) {
            const b3BodyId body = add(grain, b3_dynamicBody, surface);
            // Moments in kg m²: the scale comes in twice.
            const b3Vec3 inertia = vector(grain["inertia_kg_m2"], SCALE * SCALE);
            b3MassData mass{};
            mass.mass = unit(grain["mass_kg"].number);
            mass.inertia = {{inertia.x, 0, 0}, {0, inertia.y, 0}, {0, 0, inertia.z}};
            b3Body_SetMassData(body, mass);
            grains_.push_back(body);
        }
    }
};

void run(char **argv) {
    const peer::Job job(argv + 1);
    Laboratory lab(job, std::atoi(argv[0]));
    const b3Version version = b3GetVersion();
    peer::carry(job,
                std::to_string(version.major) + '.' + std::to_string(version.minor) + '.' +
                    std::to_string(version.revision) + " single",
                lab);
}

} // namespace

int main(int argc, char **argv) {
    return peer::main(argc, argv, 7,
                      "box3d THREADS SCENE.json RESULT.json RATE_HZ SUB_STEPS SECONDS LIMIT_S",
                      run);
}
