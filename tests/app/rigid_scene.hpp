#pragma once
// Scenes of rigid pieces ([rigid]) and what tests ask of their runs.
#include "app/program.hpp"
#include "output/history_csv.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace program {

using Json = nlohmann::json;

inline std::string material(const std::string& law) {
    return "[material.rock]\ndensity = 2500\nE = 30e9\nnu = 0.2\n[interface.default]\nfriction = 0.5\n" + law;
}
inline const std::string whole = "breakable = false\n", weak = "sigma_c = 8e6\nG_c = 200\n";
inline const std::string weight = "[[load]]\nacceleration = [0, -9.81]\n";

inline std::string block(const std::string& name, const std::string& origin, const std::string& size,
                         const std::string& more = "") {
    return "[[body]]\nname = \"" + name + "\"\nshape = \"rectangle\"\norigin = [" + origin + "]\nsize = [" + size +
           "]\n" + more;
}
inline std::string ground(const std::string& more = "friction = 0.5\n", const std::string& normal = "0, 1") {
    return "[[obstacle]]\nname = \"ground\"\nshape = \"half plane\"\nat = [0, 0]\nnormal = [" + normal + "]\n" + more;
}
inline std::string scene(const std::string& bodies, const std::string& rigid, const std::string& end,
                         const std::string& law = whole, const std::string& mesh = "0.1",
                         const std::string& more = "") {
    return "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = " + mesh + "\n" + material(law) +
           "[contact]\n[rigid]\n" + rigid + bodies + "[time]\nend = " + end + "\n" +
           "[output]\nfields = false\nhistory_every = 0.01\n" + more;
}

inline Answer run_to_end(const Folder& folder, const std::string& text, const std::string& more = " --force") {
    write_scene(folder, text);
    return run_scene(folder, "-j 1 -s 'figure=[]' -o " + folder.in_shell("run") + more);
}
inline knap::History table(const Folder& folder, const char* file) {
    return knap::read_csv(folder.path / "run" / file);
}
inline Json record(const Folder& folder) { return Json::parse(text_of(folder.path / "run/run.json")); }
inline double last(const knap::History& history, const char* column) { return history.column(column).back(); }

/// [J] Error of the balance over the largest kinetic energy.
inline double balance(const knap::History& energy) {
    double largest = 0, scale = 0;
    for (const double value : energy.column("residual")) largest = std::max(largest, std::abs(value));
    for (const double value : energy.column("kinetic")) scale = std::max(scale, value);
    return largest / scale;
}

struct Momenta {
    double x = 0, y = 0, angular = 0, scale = 0;
};
inline Momenta momenta(const Folder& folder) {
    const knap::History pieces = table(folder, "fragments.csv");
    Momenta sum;
    for (std::size_t i = 0; i < pieces.rows.size(); ++i) {
        const auto value = [&](const char* column) { return pieces.column(column)[i]; };
        const double px = value("mass") * value("velocity_x"), py = value("mass") * value("velocity_y");
        sum.x += px, sum.y += py;
        const double energy = value("kinetic_energy") - 0.5 * (px * px + py * py) / value("mass");
        const double spin = value("spin");
        sum.angular +=
            value("centre_x") * py - value("centre_y") * px + (std::abs(spin) > 1e-6 ? 2 * energy / spin : 0);
        sum.scale += std::hypot(px, py) * std::hypot(value("centre_x"), value("centre_y"));
    }
    return sum;
}

}  // namespace program
