#pragma once
// The discrete model of a mesh, its laws, loads, supports and obstacles.
#include "base/error.hpp"
#include "model/model.hpp"

#include <cstddef>
#include <string>

namespace knap {

/// A load, support, initial velocity or stress acts nowhere on the mesh.
class EmptySelection : public UserError {
public:
    enum List { loads, supports, initial_velocities, crack_pressures, initial_stresses };
    EmptySelection(List list, std::size_t number, const std::string& message)
        : UserError("empty-selection", message), list(list), number(number) {}
    List list;           // of ModelInput
    std::size_t number;  // in it, from 0
};

/// An obstacle overlaps the body at the start.
class ObstacleInBody : public UserError {
public:
    ObstacleInBody(Index number, const std::string& message, const std::string& cure)
        : UserError("overlap", message, cure), number(number) {}
    Index number;  // of the obstacle
};

/// Throws EmptySelection for selections that select nothing, BadPlace, ObstacleInBody, and other UserErrors.
Model make_model(ModelInput input);

}  // namespace knap
