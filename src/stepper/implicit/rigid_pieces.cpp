#include "stepper/implicit/rigid_pieces.hpp"

#include "stepper/implicit/implicit_bulk.hpp"

#include <Eigen/Cholesky>

#include <algorithm>

namespace knap {

void RigidPieces::find(const Model& model, const ImplicitBulk& bulk, std::vector<Index> piece_of_corner,
                       Index n_pieces) {
    of_corner = std::move(piece_of_corner);
    const Mesh& mesh = model.mesh;
    const auto for_corners = [&](const auto& visit) {
        for (Index c = 0; c < mesh.n_corners(); ++c)
            if (of_corner[c] >= 0) visit(c, pieces[of_corner[c]]);
    };
    pieces.assign(n_pieces, {});
    std::vector<double> mass(n_pieces, 0);
    for_corners([&](Index c, Piece& piece) {
        mass[of_corner[c]] += model.corner_mass[c], piece.centre += model.corner_mass[c] * bulk.place(c);
    });
    for (std::size_t p = 0; p < pieces.size(); ++p) pieces[p].centre /= mass[p];
    for_corners(
        [&](Index c, Piece& piece) { piece.length = std::max(piece.length, (bulk.place(c) - piece.centre).norm()); });
    momentum.resize(mesh.n_corners());
    std::vector<Vec2> motion, of_motion;
    for (int k = 0; k < 3; ++k) {
        motion.assign(mesh.n_corners(), Vec2::Zero());
        for_corners([&](Index c, const Piece& piece) { motion[c] = piece.motion(k, bulk.place(c)); });
        bulk.momentum(motion, of_motion);
        for (Index c = 0; c < mesh.n_corners(); ++c) momentum[c][k] = bulk.mass_factor() * of_motion[c];
    }
    inertia.assign(n_pieces, Eigen::Matrix3d::Zero());
    for_corners([&](Index c, const Piece& piece) {
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l)
                inertia[of_corner[c]](k, l) += piece.motion(k, bulk.place(c)).dot(momentum[c][l]);
    });
}

void RigidPieces::project(const std::vector<Vec2>& rate, std::vector<Eigen::Vector3d>& along) const {
    along.assign(pieces.size(), Eigen::Vector3d::Zero());
    for (std::size_t c = 0; c < of_corner.size(); ++c)
        for (int k = 0; k < 3 && of_corner[c] >= 0; ++k) along[of_corner[c]][k] += momentum[c][k].dot(rate[c]);
    for (std::size_t p = 0; p < pieces.size(); ++p) along[p] = inertia[p].ldlt().solve(along[p]).eval();
}

}  // namespace knap
