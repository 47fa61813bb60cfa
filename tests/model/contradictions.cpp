// Loads that contradict each other, and pairs of loads that only seem to.
#include "model/contradictions.hpp"

#include "model/make_model.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

namespace contradictions_test {

using namespace knap;
using namespace knap::tests;

namespace {

std::vector<Contradiction> found(const std::vector<Load>& loads, int order = 1) {
    ModelInput input = body_with(bar_mesh(4, 2, 4, 2), {.density = 1, .E = 1, .nu = 0}, {.sigma_c = 1, .G_c = 1});
    input.mesh.order = order;
    input.loads = loads;
    return find_contradictions(make_model(input), loads);
}

constexpr auto displacement = Load::Kind::displacement, velocity = Load::Kind::velocity, pull = Load::Kind::traction,
               force = Load::Kind::force;
const TimeFunction ramp{{0, 2}, {0, 1}};

}  // namespace

TEST_CASE("two motions of one component contradict each other on one boundary and at a shared corner") {
    for (const int order : {1, 2}) {
        const auto same_side =
            found({load(displacement, "top", 0.0, 1.0, ramp), load(velocity, "top", std::nullopt, 1.0)}, order);
        REQUIRE(same_side.size() == 1);
        CHECK(same_side[0].kind == Contradiction::Kind::motions);
        CHECK(same_side[0].load == std::array<std::size_t, 2>{0, 1});
        CHECK(same_side[0].component == 1);
        CHECK(same_side[0].where.y() == 2);
        const auto corner = found({load(pull, "right", 1.0, 0.0), load(velocity, "left", -1.0, std::nullopt),
                                   load(displacement, "top", 0.0, std::nullopt)},
                                  order);
        REQUIRE(corner.size() == 1);
        CHECK(corner[0].load == std::array<std::size_t, 2>{1, 2});
        CHECK(corner[0].component == 0);
        CHECK((corner[0].where - Vec2(0, 2)).norm() == 0);
        CHECK(found({load(velocity, "left", -1.0, 0.0), load(displacement, "top", 0.5, 1.0)}, order).size() ==
              2);  // x and y
    }
}

TEST_CASE("the same motion twice is no contradiction whatever its history looks like") {
    CHECK(found({load(displacement, "left", 0.0, 0.0), load(velocity, "top", 0.0, 0.0, ramp)}).empty());
    CHECK(found({load(velocity, "left", 2.0, std::nullopt, ramp),
                 load(velocity, "top", 4.0, std::nullopt, {{0, 1, 2}, {0, 0.25, 0.5}})})
              .empty());
    CHECK(found({load(velocity, "left", 2.0, std::nullopt, ramp),
                 load(velocity, "top", 2.0, std::nullopt, {{0, 1}, {0, 1}})})
              .size() == 1);
    CHECK(found({load(velocity, "left", 2.0, std::nullopt), load(velocity, "right", 3.0, std::nullopt)})
              .empty());  // they share nothing
    CHECK(found({load(velocity, "left", 2.0, std::nullopt), load(velocity, "top", std::nullopt, 3.0)}).empty());
}

TEST_CASE("a traction on a driven boundary is an error but its part on a shared corner is not") {
    CHECK(found({load(pull, "top", 0.0, 1.0), load(displacement, "left", 0.0, 0.0)}).empty());
    CHECK(found({load(pull, "top", 1.0, 0.0), load(displacement, "top", std::nullopt, 0.0)}).empty());
    const auto edge = found({load(displacement, "top", std::nullopt, 0.0), load(pull, "top", 1.0, 2.0)});
    REQUIRE(edge.size() == 1);
    CHECK(edge[0].kind == Contradiction::Kind::traction);
    CHECK(edge[0].component == 1);
    // a box with whole edges, and one with a node
    const Load middle{
        .kind = displacement, .on = {.boundary = "", .box = Box{{0.9, 1.9}, {2.1, 2.1}}}, .value = {std::nullopt, 0.0}};
    const Load node{
        .kind = displacement, .on = {.boundary = "", .box = Box{{0.9, 1.9}, {1.1, 2.1}}}, .value = {std::nullopt, 0.0}};
    CHECK(found({load(pull, "top", 0.0, 2.0), middle}).size() == 1);
    CHECK(found({load(pull, "top", 0.0, 2.0), node}).empty());
    // a pressure acts along the normal only
    const Load pressure{.kind = Load::Kind::stress, .on = {.boundary = "top", .box = {}}, .stress = {-3, -3, 0}};
    CHECK(found({pressure, load(displacement, "top", 0.0, std::nullopt)}).empty());
    CHECK(found({pressure, load(displacement, "top", std::nullopt, 0.0)}).size() == 1);
    CHECK(found({load(pull, "top", 0.0, 2.0), load(pull, "top", 0.0, 1.0), load(velocity, "left", 0.0, std::nullopt)})
              .empty());
}

TEST_CASE("a force on driven nodes only is an error") {
    const auto all = found({load(force, "left", 1.0, 0.0), load(velocity, "left", 0.0, std::nullopt)});
    REQUIRE(all.size() == 1);
    CHECK(all[0].kind == Contradiction::Kind::force);
    CHECK(found({load(force, "left", 0.0, 1.0), load(velocity, "left", 0.0, std::nullopt)}).empty());
    CHECK(found({load(force, "top", 1.0, 1.0), load(velocity, "left", 0.0, 0.0)}).empty());
}

}  // namespace contradictions_test
