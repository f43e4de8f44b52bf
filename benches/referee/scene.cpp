// Reads grains, planes and pieces from JSON, and finds the contacts between them.
#include "scene.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace referee {

namespace {

using nlohmann::json;

Vec3 three(const json &list) {
    return {list.at(0).get<double>(), list.at(1).get<double>(), list.at(2).get<double>()};
}

Hull read_hull(const json &read) {
    std::vector<Vec3> vertices;
    for (const json &v : read.at("vertices_m")) {
        vertices.push_back(three(v));
    }
    return {vertices, read.at("faces").get<std::vector<std::vector<int>>>()};
}

Quat read_rotation(const json &read) {
    const json &q = read.at("quaternion_xyzw");
    const auto part = [&](std::size_t i) { return q.at(i).get<double>(); };
    return Quat(part(3), part(0), part(1), part(2)).normalized();
}

Grain read_grain(const json &read, Material material) {
    Grain grain;
    grain.hull = read_hull(read);
    grain.material = material;
    grain.mass = read.at("mass_kg").get<double>();
    grain.inertia = three(read.at("inertia_kg_m2"));
    grain.position = three(read.at("position_m"));
    grain.rotation = read_rotation(read);
    grain.velocity = three(read.at("linear_velocity_m_per_s"));
    grain.spin = three(read.at("angular_velocity_rad_per_s"));
    return grain;
}

std::size_t material(const json &name) {
    const std::string text = name.get<std::string>();
    return text == "grain" ? 0 : text == "wall" ? 1 : 2;
}

} // namespace

void Scene::set_friction(double of_all) {
    for (auto &row : friction) {
        row.fill(of_all);
    }
}

Scene read_scene(const std::string &text) {
    const json read = json::parse(text);
    Scene scene;
    for (const json &grain : read.at("grains")) {
        scene.grains.push_back(read_grain(grain, Material::Grain));
    }
    if (read.contains("top_plate") && !read.at("top_plate").is_null()) {
        scene.grains.push_back(read_grain(read.at("top_plate"), Material::Plate));
    }
    for (const json &wall : read.value("walls_m", json::array())) {
        scene.walls.push_back({three(wall), wall.at(3).get<double>()});
    }
    for (const json &piece : read.at("apparatus")) {
        scene.pieces.push_back(
            {read_hull(piece), three(piece.at("position_m")), read_rotation(piece)});
    }
    for (const json &pair : read.at("pairs")) {
        const std::size_t a = material(pair.at("between").at(0));
        const std::size_t b = material(pair.at("between").at(1));
        scene.friction[a][b] = scene.friction[b][a] = pair.at("friction").get<double>();
        if (a == 0 && b == 0) {
            scene.restitution = pair.at("restitution").get<double>();
        }
    }
    scene.gravity = three(read.at("gravity_m_per_s2"));
    scene.restitution_threshold = read.value("restitution_threshold_m_per_s", 0.0);
    scene.closed_gap = read.value("closed_gap_m", 0.0);
    scene.met_gap = read.value("met_gap_m", 0.0);
    return scene;
}

double friction_of(const Scene &scene, const SceneTouch &touch) {
    const auto a =
        static_cast<std::size_t>(scene.grains[static_cast<std::size_t>(touch.a)].material);
    const auto wall = static_cast<std::size_t>(Material::Wall);
    const auto b =
        touch.b < 0
            ? wall
            : static_cast<std::size_t>(scene.grains[static_cast<std::size_t>(touch.b)].material);
    return scene.friction[a][b];
}

std::vector<SceneTouch> scene_touches(const Scene &scene, const std::vector<double> &margins,
                                      double doubt) {
    const auto count = static_cast<int>(scene.grains.size());
    std::vector<Placed> placed(scene.grains.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
        placed[i].place(scene.grains[i].hull, scene.grains[i].position, scene.grains[i].rotation);
    }
    // Grains in the order of their lowest x: only those whose extents overlap meet.
    std::vector<std::pair<double, int>> order;
    const auto reach = [&](int i) {
        const auto k = static_cast<std::size_t>(i);
        return scene.grains[k].hull.radius + margins[k];
    };
    for (int i = 0; i < count; ++i) {
        order.emplace_back(placed[static_cast<std::size_t>(i)].centre.x() - reach(i), i);
    }
    std::sort(order.begin(), order.end());
    std::vector<std::pair<int, int>> pairs;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const int i = order[k].second;
        const double end = placed[static_cast<std::size_t>(i)].centre.x() + reach(i);
        for (std::size_t m = k + 1; m < order.size() && order[m].first <= end; ++m) {
            pairs.emplace_back(std::min(i, order[m].second), std::max(i, order[m].second));
        }
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<SceneTouch> out;
    std::vector<Touch> found;
    const auto take = [&](int a, int b) {
        for (const Touch &touch : found) {
            out.push_back({a, b, touch});
        }
        found.clear();
    };
    std::vector<Placed> pieces(scene.pieces.size());
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        pieces[p].place(scene.pieces[p].hull, scene.pieces[p].position, scene.pieces[p].rotation);
    }
    for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        int fixed = -1;
        for (const Plane &wall : scene.walls) {
            touches(placed[k], wall, margins[k], found);
            take(i, fixed--);
        }
        for (const Placed &piece : pieces) {
            touches(placed[k], piece, margins[k], found, doubt);
            take(i, fixed--);
        }
    }
    for (const auto &[i, j] : pairs) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        touches(placed[a], placed[b], margins[a] + margins[b], found, doubt);
        take(i, j);
    }
    return out;
}

Packing measure(const Scene &scene, double touching_gap) {
    Packing packing;
    const std::vector<double> margins(scene.grains.size(), touching_gap / 2);
    std::set<std::pair<int, int>> pairs;
    for (const SceneTouch &t : scene_touches(scene, margins)) {
        packing.deepest_overlap = std::max(packing.deepest_overlap, -t.touch.gap);
        if (t.b >= 0) {
            pairs.emplace(t.a, t.b);
        }
    }
    for (const Grain &grain : scene.grains) {
        packing.mean_height += grain.position.z() / static_cast<double>(scene.grains.size());
        packing.outside += std::any_of(scene.walls.begin(), scene.walls.end(), [&](const Plane &w) {
            return w.normal.dot(grain.position) < w.offset;
        });
    }
    packing.coordination =
        2 * static_cast<double>(pairs.size()) / static_cast<double>(scene.grains.size());
    return packing;
}

} // namespace referee
