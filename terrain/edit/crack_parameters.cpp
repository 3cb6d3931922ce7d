// Li2023's parameters n, kappa and lambda, and the choice of sites, as a scene writes them. The paper's lambda has no unit; here it counts in mean
// spacings of the sites (terrain/surfaces/cracked.cpp says why).
#include "terrain/edit/crack_parameters.h"

#include <cmath>

namespace hoodoo
{

std::vector<Parameter> crack_parameters(SiteKind sites, double kappa, double kappa_most, const std::string& kappa_doc)
{
    return {
        {.name = "n",
         .type = ParameterType::integer,
         .doc = "Sites in the rectangle, whose cells the cracks part.",
         .fallback = std::int64_t{200},
         .minimum = 1,
         .maximum = 1e6},
        {.name = "sites",
         .type = ParameterType::choice,
         .doc = "random: independent, as in the paper; even: as far from each other as the best of 16 draws.",
         .fallback = std::string(sites == SiteKind::even ? "even" : "random"),
         .choices = {"random", "even"}},
        {.name = "kappa", .type = ParameterType::number, .doc = kappa_doc, .fallback = kappa, .minimum = 0, .maximum = kappa_most},
        {.name = "lambda",
         .type = ParameterType::number,
         .doc = "Width of a crack, share of the mean spacing of the sites, sqrt(area / n).",
         .fallback = 0.1,
         .minimum = 0,
         .maximum = 10,
         .above_minimum = true},
    };
}

std::vector<Parameter> crack_region_parameters(const std::string& doc)
{
    Parameter low{.name = "region_min",
                  .type = ParameterType::vector,
                  .doc = "Lower corner (x, y) of the rectangle " + doc,
                  .unit = "m",
                  .min_count = 2,
                  .max_count = 2};
    Parameter high = low;
    high.name = "region_max", high.doc = "Upper corner of it.";
    return {std::move(low), std::move(high)};
}

CrackNetwork crack_network(const Values& values, std::uint64_t seed, const Vec2d& size)
{
    const auto n = static_cast<int>(values.integer("n"));
    const Box2d area(Vec2d(0.0), size);
    const SiteKind kind = values.text("sites") == "even" ? SiteKind::even : SiteKind::random;
    return {VoronoiDiagram(crack_sites(seed, n, area, kind), crack_box(n, area)), values.number("lambda") * std::sqrt(size.x * size.y / n)};
}

}  // namespace hoodoo
