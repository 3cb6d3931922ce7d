// The tree stands in a scene as a flat list of named nodes, as that of `implicit` does (node_tables.h). Curves are flattened (path_tables.h); what a
// node's weight does not reach, no ray asks it about.
#include "terrain/surfaces/landform_nodes.h"

#include "terrain/error.h"
#include "terrain/fields/elevation.h"
#include "terrain/fields/terrain_dictionary.h"
#include "terrain/math/hash.h"
#include "terrain/surfaces/landform_schemas.h"
#include "terrain/surfaces/noise_parameters.h"
#include "terrain/surfaces/node_tables.h"
#include "terrain/surfaces/path_tables.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

Falloff read_falloff(const Values& v)
{
    const Falloff falloff{v.number("radius"), v.number("core"), static_cast<int>(v.integer("power"))};
    if (!(falloff.core < falloff.radius))
        throw v.problem("core", "where the weight begins to fall", "less than the radius", fmt::format("{} m of {} m", falloff.core, falloff.radius));
    return falloff;
}

Section read_section(const Values& v)
{
    Section section;
    if (!v.has("profile")) return section;
    const std::vector<double>& numbers = v.vector("profile");
    if (numbers.size() % 2 != 0)
        throw v.problem("profile", "a profile", "a distance and a height of each knot in turn", fmt::format("{} numbers", numbers.size()));
    for (std::size_t n = 0; n < numbers.size(); n += 2) {
        const bool first = n == 0;
        if (numbers[n] < 0.0 || (!first && !(numbers[n] > numbers[n - 2]))) {
            throw v.problem("profile", "distances of a profile", "0 or more, each larger than the last",
                            first ? fmt::format("{}", numbers[n]) : fmt::format("{} after {}", numbers[n], numbers[n - 2]));
        }
        section.knots.emplace_back(numbers[n], numbers[n + 1]);
    }
    section.sharp = v.boolean("sharp");
    return section;
}

constexpr int kMostPatches = 1 << 20;

class Builder final : private NodeTables<Landform>
{
public:
    Builder(const Values& row, const BuildContext& context) : NodeTables(row), row_(row), context_(context) {}

    LandformPtr build()
    {
        LandformPtr root = build_root();
        if (!root->covers())
            throw row_.problem("node", "the landforms do not cover the plane", "a root that stands on flat, noise or terrain nodes without an end");
        return root;
    }

private:
    std::uint32_t seed_of(const std::string& name) const { return static_cast<std::uint32_t>(hash_name(context_.seed, name) >> 32); }

    LandformPtr make(const Values& v, const std::string& name) override
    {
        const std::string& kind = v.variant();
        if (kind == "flat") return landform_flat(v.number("height"));
        if (kind == "noise") return noise(v, name);
        if (kind == "terrain") return terrain(v);
        if (kind == "point" || kind == "segment" || kind == "curve") return path(v, name);
        if (kind == "dictionary") return dictionary(v);
        if (kind == "blend") return blend(v);
        if (kind == "warp") return warp(v, name);
        if (kind == "move") return landform_move(part(v), v.number("scale"), v.number("turn"), v.vec3("shift"));
        return apply(v, kind);
    }

    LandformPtr noise(const Values& v, const std::string& name)
    {
        ElevationShape shape = read_noise(v, "noise");
        shape.height = v.number("height");
        shape.seed = seed_of(name);
        auto height = std::make_shared<const ElevationHeight>(shape);
        if (v.has("at") != v.has("radius"))
            throw v.problem(v.has("at") ? "at" : "radius", "a circle of noise", "both at and radius, or neither", v.has("at") ? "at" : "radius");
        if (!v.has("at")) return landform_of(std::move(height));
        return landform_disc(std::move(height), v.vec2("at"), read_falloff(v));
    }

    /// The surface that a parameter names, if it is a height.
    std::shared_ptr<const Surface> other(const Values& v, const std::string& key) const
    {
        const std::string& name = v.text(key);
        if (!context_.base) throw v.problem(key, "there is no other terrain to stand on", "the name of a terrain", '"' + name + '"');
        std::shared_ptr<const Surface> base = context_.base(name, v.where(key));
        if (!base->height())
            throw v.problem(key, "landforms cannot stand on this terrain: it is no height", "a terrain with one height over each point",
                            '"' + name + '"');
        return base;
    }

    LandformPtr terrain(const Values& v)
    {
        const std::shared_ptr<const Surface> base = other(v, "terrain");
        return landform_of(std::shared_ptr<const Height>(base, base->height()), base->info().trace_bytes);
    }

    /// A rectangle in which a height says something.
    static Box2d area_of(const Values& v, const std::string& key, const std::string& terrain, const Box2d& domain)
    {
        if (!v.has(key)) {
            if (!std::isfinite(domain.size().length2()))
                throw v.problem(terrain, "this terrain has no end", "an area beside it: " + key, '"' + v.text(terrain) + '"');
            return domain;
        }
        const std::vector<double>& a = v.vector(key);
        const Box2d area(Vec2d(a[0], a[1]), Vec2d(a[2], a[3]));
        if (!(a[0] < a[2] && a[1] < a[3]))
            throw v.problem(key, "an area", "x and y from, then x and y to, both larger", fmt::format("[{}, {}, {}, {}]", a[0], a[1], a[2], a[3]));
        if (!domain.intersects(area.min) || !domain.intersects(area.max))
            throw v.problem(key, "an area of \"" + v.text(terrain) + '"',
                            fmt::format("a part of {:.6g}, {:.6g} to {:.6g}, {:.6g}", domain.min.x, domain.min.y, domain.max.x, domain.max.y),
                            fmt::format("[{}, {}, {}, {}]", a[0], a[1], a[2], a[3]));
        return area;
    }

    LandformPtr dictionary(const Values& v)
    {
        const std::shared_ptr<const Surface> coarse = other(v, "terrain"), exemplar = other(v, "exemplar");
        DictionaryOptions options;
        options.spacing = v.number("spacing");
        options.detail = v.has("detail") ? v.number("detail") : options.spacing / 32.0;
        options.atoms = static_cast<int>(v.integer("atoms"));
        options.terms = static_cast<int>(v.integer("terms"));
        if (!(options.detail >= options.spacing / 1024.0 && options.detail <= options.spacing))
            throw v.problem("detail", "the distance of samples", "from a 1024th of the spacing to all of it",
                            fmt::format("{:.6g} m beside {:.6g} m", options.detail, options.spacing));
        const Box2d area = area_of(v, "area", "terrain", coarse->height()->domain());
        const Box2d from = area_of(v, "exemplar_area", "exemplar", exemplar->height()->domain());
        const double needed = TerrainDictionary::needed_size(options.spacing), side = std::min(from.size().x, from.size().y);
        if (!(side >= needed))
            throw v.problem("spacing", "the exemplar is too small for a patch",
                            fmt::format("a spacing of at most {:.6g} m", options.spacing * side / needed), fmt::format("{:.6g} m", options.spacing));
        const double count = (area.size().x / options.spacing + 1.0) * (area.size().y / options.spacing + 1.0);
        if (!(count <= kMostPatches))
            throw v.problem("spacing", "too many patches", fmt::format("at most {}", kMostPatches), fmt::format("about {:.3g}", count));
        const Interval heights = exemplar->height()->range(from);
        if (!(heights.hi > heights.lo)) throw v.problem("exemplar", "the exemplar is level", "a terrain with relief", '"' + v.text("exemplar") + '"');
        const TerrainDictionary dictionary(*exemplar->height(), from, options);
        return dictionary.landform(dictionary.represent(*coarse->height(), area));
    }

    LandformPtr path(const Values& v, const std::string& name)
    {
        PathForm form;
        form.falloff = read_falloff(v);
        form.section = read_section(v);
        form.joint = 0.25 * form.falloff.radius;
        if (v.variant() == "point") {
            form.points = {v.vec3("at")};
        } else {
            form.points = v.variant() == "segment" ? v.points("points") : path_of(v, {}).points;
            if (v.variant() == "curve" && v.has("joint")) form.joint = v.number("joint");
        }
        for (std::size_t n = 0; n + 1 < form.points.size(); ++n) {
            const Vec3d step = form.points[n + 1] - form.points[n];
            if (!(std::hypot(step.x, step.y) > 0.0))
                throw v.problem("points", "neighbouring points of a path", "places apart on the map",
                                fmt::format("two at ({:.6g}, {:.6g})", form.points[n].x, form.points[n].y));
        }
        if (v.has("rough") != v.has("rough_wavelength"))
            throw v.problem(v.has("rough") ? "rough" : "rough_wavelength", "a rough landform", "both rough and rough_wavelength",
                            v.has("rough") ? "rough" : "rough_wavelength");
        if (v.has("rough")) {
            ElevationShape rough;
            rough.kind = v.text("rough_noise") == "ridged"   ? ElevationKind::ridged
                         : v.text("rough_noise") == "billow" ? ElevationKind::billow
                                                             : ElevationKind::fbm;
            rough.relief = v.number("rough");
            rough.wavelength = v.number("rough_wavelength");
            rough.fractal.octaves = v.number("rough_octaves");
            rough.seed = seed_of(name);
            form.rough = std::make_shared<const ElevationHeight>(rough);
        }
        return landform_path(form);
    }

    LandformPtr blend(const Values& v)
    {
        std::vector<LandformPtr> nodes = parts(v);
        const bool united = v.text("weight") == "united";
        for (std::size_t n = 0; united && n < nodes.size(); ++n)
            if (nodes[n]->most_weight() > 1.0)
                throw v.problem("weight", "united weights are those of nodes whose own are at most 1", "weight = \"sum\", or other nodes",
                                '"' + v.names("of")[n] + '"');
        return landform_blend(std::move(nodes), united ? BlendWeight::united : BlendWeight::sum);
    }

    LandformPtr apply(const Values& v, const std::string& kind)
    {
        std::vector<LandformPtr> nodes = parts(v);
        const LandformOperator what = kind == "replace" ? LandformOperator::replace
                                      : kind == "inset" ? LandformOperator::inset
                                      : kind == "add"   ? LandformOperator::add
                                      : kind == "max"   ? LandformOperator::raise
                                                        : LandformOperator::lower;
        if (what == LandformOperator::replace && !nodes[0]->covers())
            throw v.problem("of", "what is replaced must cover the plane", "a node that stands on flat, noise or terrain first; or kind = \"inset\"",
                            '"' + v.names("of")[0] + '"');
        return landform_apply(what, std::move(nodes));
    }

    LandformPtr warp(const Values& v, const std::string& name)
    {
        ElevationShape shape;
        shape.relief = v.number("amplitude");
        shape.wavelength = v.number("wavelength");
        shape.fractal.octaves = v.number("octaves");
        shape.seed = seed_of(name + " x");
        auto x = std::make_shared<const ElevationHeight>(shape);
        shape.seed = seed_of(name + " y");
        return landform_warp(part(v), std::move(x), std::make_shared<const ElevationHeight>(shape));
    }

    const Values& row_;
    const BuildContext& context_;
};

}  // namespace

LandformPtr make_landform_tree(const Values& row, const BuildContext& context)
{
    return Builder(row, context).build();
}

}  // namespace hoodoo
