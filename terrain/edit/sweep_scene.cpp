// A sweep as a scene writes it: a path with radii for the simple case, nodes, arcs and profiles for the whole of it.
// Peytavie2009, section 4.2: the nodes of a graph store the profile curves. Missing: profiles from files.
#include "terrain/edit/sweep_scene.h"

#include "terrain/edit/aim.h"
#include "terrain/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr int kCorners = 64;

std::vector<std::string> material_names(bool air)
{
    std::vector<std::string> names;
    for (std::size_t m = air ? 0 : 1; m < kMaterialCount; ++m) names.push_back(material_name(static_cast<Material>(m)));
    return names;
}

Schema profile_schema()
{
    return {"profile",
            "A cross section: x to the right when one looks along the arc, y along the normal.",
            {{.name = "name", .type = ParameterType::text, .doc = "What nodes call it.", .fallback = std::string()},
             {.name = "curve",
              .type = ParameterType::vector,
              .doc = "Control points of a closed smooth curve: x and y of each in turn.",
              .unit = "m",
              .min_count = 1,
              .max_count = 2048},
             {.name = "width",
              .type = ParameterType::length,
              .doc = "Of an ellipse; instead of a curve.",
              .unit = "m",
              .minimum = 0,
              .above_minimum = true},
             {.name = "height",
              .type = ParameterType::length,
              .doc = "Of an ellipse; its width by default.",
              .unit = "m",
              .minimum = 0,
              .above_minimum = true}}};
}

Schema node_schema()
{
    return {"node",
            "A place of the skeleton.",
            {{.name = "name", .type = ParameterType::text, .doc = "What arcs call it.", .required = true},
             {.name = "at", .type = ParameterType::vector, .doc = "Where it is.", .required = true, .unit = "m", .min_count = 3, .max_count = 3},
             {.name = "profile",
              .type = ParameterType::text,
              .doc = "Name of the cross section there; the first one by default.",
              .fallback = std::string()},
             {.name = "scale", .type = ParameterType::number, .doc = "Of the cross section.", .fallback = 1.0, .minimum = 0, .above_minimum = true},
             {.name = "roll",
              .type = ParameterType::angle,
              .doc = "Turns the cross section about the arc, to the right.",
              .fallback = 0.0,
              .unit = "rad"}}};
}

Schema arc_schema()
{
    return {"arc",
            "A branch of the skeleton.",
            {{.name = "nodes",
              .type = ParameterType::names,
              .doc = "Names of the nodes it visits.",
              .required = true,
              .min_count = 2,
              .max_count = 100000}}};
}

std::vector<Parameter> shape_parameters()
{
    return {
        {.name = "points",
         .type = ParameterType::points,
         .doc = "A single path; instead of nodes and arcs.",
         .unit = "m",
         .min_count = 1,
         .max_count = 100000},
        {.name = "radius",
         .type = ParameterType::vector,
         .doc = "With points: a round tool; one radius, or one for each point.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true,
         .min_count = 1,
         .max_count = 100000},
        {.name = "profile",
         .type = ParameterType::tables,
         .doc = "Cross sections; along points they follow one another evenly.",
         .max_count = 256,
         .items = {profile_schema()}},
        {.name = "node", .type = ParameterType::tables, .doc = "Places of the skeleton.", .max_count = 100000, .items = {node_schema()}},
        {.name = "arc", .type = ParameterType::tables, .doc = "Branches of the skeleton.", .max_count = 100000, .items = {arc_schema()}},
        {.name = "smooth", .type = ParameterType::boolean, .doc = "Curves through the nodes instead of straight pieces.", .fallback = true},
    };
}

/// A scene's sweep, read and checked.
class Reader
{
public:
    explicit Reader(const Values& edit) : edit_(edit) {}

    SweepTool read(std::uint64_t seed)
    {
        if (edit_.points("points").empty() == edit_.tables("node").empty()) {
            throw edit_.problem(edit_.points("points").empty() ? "node" : "points", "skeleton of a sweep", "either points, or nodes and arcs",
                                edit_.points("points").empty() ? "neither" : "both");
        }
        read_profiles();
        edit_.points("points").empty() ? read_graph() : read_path();
        check_spans();
        tool_.smooth = edit_.boolean("smooth");
        tool_.carried = edit_.text("frames") == "carried";
        tool_.round_ends = edit_.text("ends") == "round";
        tool_.roughness = edit_.number("roughness");
        tool_.bedding = edit_.number("bedding");
        tool_.seed = static_cast<std::uint32_t>(seed);
        tool_.wavelength = edit_.has("wavelength") ? edit_.number("wavelength") : mean_size();
        return std::move(tool_);
    }

private:
    double mean_size() const
    {
        double sum = 0.0;
        for (const SweepNode& node : tool_.nodes) sum += node.scale * mean_radius(tool_.profiles[node.profile]);
        return sum / static_cast<double>(tool_.nodes.size());
    }

    /// Rough walls need corners as near to one another as their noise is fine.
    int corners(double radius) const
    {
        if (!(edit_.number("roughness") > 0.0) || !edit_.has("wavelength")) return kCorners;
        return static_cast<int>(std::clamp(2.0 * M_PI * radius / (edit_.number("wavelength") / 6.0), 1.0 * kCorners, 8.0 * kCorners));
    }

    void read_profiles()
    {
        const std::vector<Values>& tables = edit_.tables("profile");
        if (tables.empty() != edit_.has("radius") || (edit_.has("radius") && edit_.points("points").empty())) {
            throw edit_.problem(edit_.has("radius") ? "radius" : "profile", "cross section of a sweep", "profiles, or with points a radius instead",
                                edit_.has("radius") ? (tables.empty() ? "a radius with nodes" : "both") : "neither");
        }
        if (edit_.has("radius")) {
            const std::vector<double>& radii = edit_.vector("radius");
            tool_.profiles = {ellipse(2.0, 2.0, corners(*std::max_element(radii.begin(), radii.end())))};
            return;
        }
        // All have the same number of corners: that of the largest.
        int most = kCorners;
        for (const Values& table : tables) most = std::max(most, corners(mean_radius(profile(table, kCorners))));
        for (const Values& table : tables) tool_.profiles.push_back(profile(table, most));
    }

    static Profile2 profile(const Values& table, int corners)
    {
        if (table.has("curve") == table.has("width"))
            throw table.problem("curve", "a profile", "either a curve or a width", table.has("curve") ? "both" : "neither");
        if (table.has("width")) return ellipse(table.number("width"), table.number(table.has("height") ? "height" : "width"), corners);
        const std::vector<double>& numbers = table.vector("curve");
        if (numbers.size() < 6 || numbers.size() % 2 != 0) {
            throw table.problem("curve", "curve of a profile", "at least 3 points, x and y of each in turn",
                                numbers.size() % 2 != 0 ? fmt::format("{} numbers", numbers.size()) : fmt::format("{} points", numbers.size() / 2));
        }
        std::vector<Vec2d> control;
        for (std::size_t k = 0; k < numbers.size(); k += 2) control.emplace_back(numbers[k], numbers[k + 1]);
        return closed_spline(control, corners);
    }

    void read_path()
    {
        const std::vector<Vec3d>& points = edit_.points("points");
        tool_.skeleton.nodes = points;
        std::vector<std::size_t>& arc = tool_.skeleton.arcs.emplace_back();
        const std::size_t profiles = tool_.profiles.size();
        for (std::size_t k = 0; k < points.size(); ++k) {
            arc.push_back(k);
            SweepNode node;
            node.profile = points.size() > 1 ? (k * (profiles - 1) + (points.size() - 1) / 2) / (points.size() - 1) : 0;
            if (edit_.has("radius")) node.scale = radius(k, points.size());
            tool_.nodes.push_back(node);
        }
    }

    double radius(std::size_t k, std::size_t points) const
    {
        const std::vector<double>& radii = edit_.vector("radius");
        if (radii.size() != 1 && radii.size() != points) {
            throw edit_.problem("radius", "radii of a sweep", fmt::format("one, or one for each of the {} points", points),
                                fmt::to_string(radii.size()));
        }
        return radii.size() == 1 ? radii[0] : radii[k];
    }

    /// Place of a name in a list; an error at `values` that names the nearest.
    static std::size_t find(const std::vector<std::string>& names, const std::string& name, const Values& values, const char* key, const char* what)
    {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
        throw Error(ErrorKind::scene,
                    Problem{values.where(key), fmt::format("no {} has this name", what), {}, "\"" + name + "\"", nearest_name(name, names)});
    }

    void read_graph()
    {
        std::vector<std::string> profiles, nodes;
        for (const Values& table : edit_.tables("profile")) profiles.push_back(table.text("name"));
        for (const Values& table : edit_.tables("node")) {
            if (std::find(nodes.begin(), nodes.end(), table.text("name")) != nodes.end()) {
                throw table.problem("name", "two nodes have one name", "another name", "\"" + table.text("name") + "\"");
            }
            nodes.push_back(table.text("name"));
            tool_.skeleton.nodes.push_back(table.vec3("at"));
            const std::string& profile = table.text("profile");
            tool_.nodes.push_back(
                {profile.empty() ? 0 : find(profiles, profile, table, "profile", "profile"), table.number("scale"), table.number("roll")});
        }
        if (edit_.tables("arc").empty()) throw edit_.problem("arc", "skeleton of a sweep", "at least one arc between its nodes", "none");
        for (const Values& table : edit_.tables("arc")) {
            std::vector<std::size_t>& arc = tool_.skeleton.arcs.emplace_back();
            for (const std::string& name : table.names("nodes")) arc.push_back(find(nodes, name, table, "nodes", "node"));
        }
    }

    void check_spans() const
    {
        const char* key = edit_.points("points").empty() ? "arc" : "points";
        for (const auto& arc : tool_.skeleton.arcs) {
            for (std::size_t k = 0; k + 1 < arc.size(); ++k) {
                const Vec3d &a = tool_.skeleton.nodes[arc[k]], &b = tool_.skeleton.nodes[arc[k + 1]];
                if (!((b - a).length() > 0.0)) {
                    throw edit_.problem(key, "two neighbouring nodes of a sweep lie at one place", "places apart",
                                        fmt::format("({}, {}, {}) m", a.x, a.y, a.z));
                }
            }
        }
    }

    const Values& edit_;
    SweepTool tool_;
};

}  // namespace

Schema sweep_schema()
{
    Schema schema{"sweep",
                  "Sweeps cross sections along a branching path and takes what they meet away: tunnels, ravines, fractures. Or puts it there.",
                  shape_parameters()};
    const std::vector<Parameter> more = {
        {.name = "mode",
         .type = ParameterType::choice,
         .doc = "Whether the tool takes away or puts there.",
         .fallback = std::string("carve"),
         .choices = {"carve", "add"}},
        {.name = "removes",
         .type = ParameterType::names,
         .doc = "What it takes away; everything by default.",
         .fallback = material_names(false),
         .choices = material_names(false),
         .min_count = 1,
         .max_count = 5},
        {.name = "material",
         .type = ParameterType::choice,
         .doc = "What it puts there.",
         .fallback = std::string("bedrock"),
         .choices = material_names(false)},
        {.name = "project",
         .type = ParameterType::boolean,
         .doc = "Lay the path onto the bedrock's surface first: cracks and ravines.",
         .fallback = false},
        {.name = "frames",
         .type = ParameterType::choice,
         .doc = "carried: sections turn as little as possible along an arc; fixed: their normal is up, or the surface's, everywhere.",
         .fallback = std::string("carried"),
         .choices = {"carried", "fixed"}},
        {.name = "ends",
         .type = ParameterType::choice,
         .doc = "Of branches that end free.",
         .fallback = std::string("round"),
         .choices = {"round", "flat"}},
        {.name = "roughness",
         .type = ParameterType::number,
         .doc = "Share of its distance from the path by which noise moves the wall.",
         .fallback = 0.0,
         .minimum = 0,
         .maximum = 0.95},
        {.name = "wavelength",
         .type = ParameterType::length,
         .doc = "Size of that noise; the tool's mean radius by default.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "bedding",
         .type = ParameterType::number,
         .doc = "How many times flatter than wide that noise is: ledges in the wall.",
         .fallback = 1.0,
         .minimum = 0.1,
         .maximum = 100},
    };
    schema.parameters.insert(schema.parameters.end(), more.begin(), more.end());
    for (Parameter& p : aim_parameters()) {
        if (p.name == "along") {
            p.doc = "With project: direction in which the path is moved onto the surface (from rock: backwards).";
            p.fallback = std::vector<double>{0, 0, -1};
        }
        schema.parameters.push_back(std::move(p));
    }
    return schema;
}

SweepTool read_sweep(const Values& edit, std::uint64_t seed)
{
    return Reader(edit).read(seed);
}

}  // namespace hoodoo
