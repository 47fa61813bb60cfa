#include "scenario/units.hpp"

#include "base/text.hpp"

#include <doctest/doctest.h>

#include <clocale>
#include <cmath>

namespace units_test {

using namespace knap;

namespace {

struct Case {
    const char* text;
    double value;
    const char* kind;
};

const Case cases[] = {
    {"40 mm", 40e-3, "a length"},
    {"0.3 mm", 0.3e-3, "a length"},
    {"40mm", 40e-3, "a length"},
    {"-2.5e-1 um", -2.5e-7, "a length"},
    {"+3 \u00b5m", 3e-6, "a length"},
    {"7 \u03bcm", 7e-6, "a length"},
    {"1e3 nm", 1e-6, "a length"},
    {"2 cm", 0.02, "a length"},
    {".5 km", 500, "a length"},
    {"80 us", 80e-6, "a time"},
    {"2 min", 120, "a time"},
    {"1 h", 3600, "a time"},
    {"2 day", 172800, "a time"},
    {"0.5 year", 15778800, "a time"},
    {"3 mm/year", 3e-3 / 31557600, "a speed"},
    {"7 /s", 7, "a rate"},
    {"7/s", 7, "a rate"},
    {"8e-6 /K", 8e-6, "an expansion per temperature"},
    {"3.08 MPa", 3.08e6, "a pressure"},
    {"32 GPa", 32e9, "a pressure"},
    {"5 N/mm2", 5e6, "a pressure"},
    {"5 N/mm^2", 5e6, "a pressure"},
    {"2 bar", 2e5, "a pressure"},
    {"2450 kg/m3", 2450, "a density"},
    {"1.18e-3 g/mm3", 1180, "a density"},
    {"7.8e-9 t/mm3", 7800, "a density"},
    {"2.45 g/cm3", 2450, "a density"},
    {"12 kN", 12e3, "a force"},
    {"1 kg m/s2", 1, "a force"},
    {"10 m/s", 10, "a speed"},
    {"1 mm/ms", 1, "a speed"},
    {"36 km/h", 10, "a speed"},
    {"9.81 m/s2", 9.81, "an acceleration"},
    {"9.81 m s^-2", 9.81, "an acceleration"},
    {"3 J/m2", 3, "an energy per area"},
    {"0.14 N/mm", 140, "an energy per area"},
    {"22.13 kJ/m2", 22130, "an energy per area"},
    {"3 N/m3", 3, "a force per volume"},
    {"2 MN/m3", 2e6, "a force per volume"},
    {"12 mJ", 12e-3, "an energy"},
    {"45 deg", 45, "an angle"},
    {"0.65 cR", 0.65, "a multiple of the Rayleigh speed"},
    {"20 CFL", 20, "a multiple of the stable step"},
    {"2 %", 0.02, "a plain number"},
    {"0.2", 0.2, "a plain number"},
    {"50 1/s", 50, "a rate"},
    {"8e-6 1/K", 8e-6, "an expansion per temperature"},
    {"8 um/m/K", 8e-6, "an expansion per temperature"},
    {"50 Hz", 50, "a rate"},
    {"3 kg2/s", 3, "something in kg^2 s^-1"},
};

}  // namespace

TEST_CASE("units: values and kinds") {
    for (const Case& c : cases) {
        CAPTURE(c.text);
        const Quantity q = parse_quantity(c.text);
        if (!c.kind) {
            CHECK_FALSE(q.problem.empty());
            continue;
        }
        CHECK(q.problem == "");
        CHECK(kind_name(q.dimension) == c.kind);
        CHECK(std::abs(q.value - c.value) <= 4e-16 * std::abs(c.value));
    }
    CHECK(std::abs(parse_quantity("3.141592653589793 rad").value - 180) < 1e-12);
}

TEST_CASE("units: a power of ten leaves no rounding error") {
    CHECK(parse_quantity("0.3 mm").value == 0.3e-3);
    CHECK(parse_quantity("0.7 us").value == 0.7e-6);
    CHECK(parse_quantity("1.18e-3 g/mm3").value == 1.18e3);
    CHECK(parse_quantity("3.3 MPa").value == 3.3e6);
}

TEST_CASE("units: what is no quantity") {
    for (const char* text :
         {"",         " ",     "mm",    "abc",   "nan",     "inf m",  "- 3 mm",  "1,5 mm",          "3 parsec",
          "3 m/",     "3 //m", "3 mm0", "3 mm^", "3 mm^^2", "3 m//s", "1e999 m", "1e99999999999 m", ".",
          "3 m m3 4", "3 kkm", "3 m12", "0x10 m"}) {
        CAPTURE(text);
        CHECK_FALSE(parse_quantity(text).problem.empty());
    }
    CHECK(parse_quantity("1,5 mm").problem.find("comma") != std::string::npos);
}

TEST_CASE("units: the locale does not matter") {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* locale : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) std::setlocale(LC_ALL, locale);
    CHECK(parse_quantity("1.5 mm").value == 1.5e-3);
    CHECK(shortest(0.1) == "0.1");
    std::setlocale(LC_ALL, before.c_str());
}

TEST_CASE("units: shortest text reads back") {
    for (const double x : {0.1, 1.0 / 3, 3.08e6, 5e-324, 1.7976931348623157e308, -0.0})
        CHECK(parse_quantity(shortest(x)).value == x);
    CHECK(shortest(-0.0) == "-0.0");
}

}  // namespace units_test
