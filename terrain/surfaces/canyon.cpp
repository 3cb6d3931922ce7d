// The canyon as a terrain: walls, plateau and floor, each cut into patches of its own and met by rays where the others leave it bare.
// Gamito2001, section 4.1, Figures 6 to 8; fields/canyon.h has the functions. Matter is min(floor, max(wall, plateau)), so a crossing of one part
// counts where the others say so: of a wall below the plateau and above the floor, of the plateau in rock, of the floor in the open. The three
// overlap by a hair at their edges, so that no ray slips between them. The canyon is infinite; what is traced is a square of the radius `extent`
// about the eye's place (or the origin), in patches that grow with the distance. Mode "paper" takes the walls by the area test instead, whole rays at
// a time. Deviations: strata are colours by height of the look, and the deposit at the foot shows as sand. The vertical deformation of section 5
// lifts layers and plateau by a noise of the plan.
// Missing: the map of arrival times tau*(x, y), rock where T(z) < tau*, whose boxes need not be as flat as a layer. Over a box its distance from a
// quadratic is provable as patch_model.h proves its own, by D2 tau* = -(F_xx + 2 F_xT tau_x + F_TT tau_x^2) / F_T, but only where |F_T|, which is
// |grad n|^2, is bounded from below: about the noise's critical points, and where they are what a wall is made of, the present boxes would have to
// stay.
#include "terrain/error.h"
#include "terrain/fields/canyon.h"
#include "terrain/surfaces/marched_surface.h"
#include "terrain/math/hash.h"
#include "terrain/surfaces/patch_parameters.h"
#include "terrain/surfaces/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace hoodoo
{

namespace
{

enum class Part : std::uint32_t { wall, plateau, floor };

/// One part of the canyon as something to march.
class PartField final : public MarchedField
{
public:
    PartField(const CanyonField& canyon, Part part, double hair) : canyon_(canyon), part_(part), hair_(hair) {}

    double value(const Vec3d& p, double) const override
    {
        return part_ == Part::wall ? canyon_.wall().value(p) : part_ == Part::plateau ? canyon_.plateau(p) : canyon_.floor(p);
    }

    bool batched() const override { return part_ == Part::wall; }
    void values(const Vec3d (&p)[batch], int count, double time, double* out) const override
    {
        if (part_ != Part::wall) return MarchedField::values(p, count, time, out);
        double all[batch];
        canyon_.wall().values(p, all);
        std::copy_n(all, count, out);
    }

    LocalField local(const Box3d& box) const override
    {
        const LocalField top = canyon_.plateau_local(box), ground = canyon_.floor_local(box);
        const LocalField nothing{{kInfinity, -kInfinity}, 0.0, {}, 0.0, 0.0, 0.0};
        // Walls and plateau are bare above the floor, walls below the plateau too.
        if (part_ != Part::floor && ground.value.hi < -hair_) return nothing;
        if (part_ == Part::wall) return top.value.lo > hair_ ? nothing : canyon_.wall().local(box);
        LocalField known = part_ == Part::plateau ? top : ground;
        if (known.value.lo > hair_ || known.value.hi < -hair_) return nothing;
        const LocalField wall = canyon_.wall().local(box);
        if (part_ == Part::plateau ? wall.value.lo > hair_ : std::max(wall.value.hi, top.value.hi) < -hair_) return nothing;
        return known;
    }

    bool exists(const Vec3d& p, double) const override
    {
        const double top = canyon_.plateau(p), ground = canyon_.floor(p);
        switch (part_) {
            case Part::wall:
                return top <= hair_ && ground >= -hair_;
            case Part::plateau:
                return ground >= -hair_ && !in_air(p);
            case Part::floor:
                return top >= -hair_ || !in_rock(p);
        }
        return false;
    }

    bool exists_throughout(const Box3d& box) const override
    {
        const Interval top = canyon_.plateau_local(box).value, ground = canyon_.floor_local(box).value;
        switch (part_) {
            case Part::wall:
                return top.hi <= hair_ && ground.lo >= -hair_;
            case Part::plateau:
                return ground.lo >= -hair_ && canyon_.wall().local(box).value.hi <= hair_;
            case Part::floor:
                return top.lo >= -hair_ || canyon_.wall().local(box).value.lo >= -hair_;
        }
        return false;
    }

    Vec3d inverse(const Vec3d& p, double) const override { return part_ == Part::wall ? canyon_.wall().inverse(p) : p; }
    double base_value(const Vec3d& q) const override { return part_ == Part::wall ? canyon_.wall().base_value(q) : value(q, 0.0); }

private:
    /// Beside the walls, by more than a hair.
    bool in_air(const Vec3d& p) const
    {
        const int sign = canyon_.wall().certain_sign(p, hair_);
        return sign > 0 || (sign == 0 && wall_value(p) > hair_);
    }
    bool in_rock(const Vec3d& p) const
    {
        const int sign = canyon_.wall().certain_sign(p, hair_);
        return sign < 0 || (sign == 0 && wall_value(p) < -hair_);
    }
    /// In SIMD lanes eight points cost less than one by itself.
    double wall_value(const Vec3d& p) const
    {
        Vec3d same[batch];
        double all[batch];
        std::fill_n(same, batch, p);
        canyon_.wall().values(same, all);
        return all[0];
    }

    const CanyonField& canyon_;
    Part part_;
    double hair_;
};

class CanyonSurface final : public Surface
{
public:
    CanyonSurface(const CanyonShape& shape, PatchSettings settings)
        : field_(shape), accuracy_(settings.accuracy), flat_(settings.flat), size_(settings.size)
    {
        const Box3d domain = settings.domain;
        field_.prepare(domain);
        const double floor_top = shape.origin.z + shape.height * shape.floor_amplitude * 2.3, hair = 0.01 * settings.size;
        for (const Part part : {Part::wall, Part::plateau, Part::floor}) {
            // The plateau and the floor are nearly flat: larger boxes do, and no mode but one.
            PatchSettings own = settings;
            own.domain = domain;
            own.cut_edges = true;
            if (part == Part::plateau) own.domain.min.z = shape.origin.z + shape.height - CanyonLift::bound(shape).value - hair;
            if (part == Part::floor) own.domain.max.z = std::min(domain.max.z, floor_top + hair);
            if (part != Part::wall) own.size *= 2.0, own.mode = MarchMode::certified;
            Body& body = bodies_[static_cast<std::size_t>(part)];
            body.field = std::make_unique<PartField>(field_, part, kHair * shape.cell);
            body.patches = make_field_patches(*body.field, own);
            body.first_tile = tiles_;
            tiles_ += body.patches->tile_count();
        }
    }
    void set_build_seconds(double seconds) { build_seconds_ = seconds; }

    std::uint32_t tile_count() const override { return tiles_; }
    std::uint32_t patch_count(std::uint32_t tile) const override { return body_of(tile).patches->patch_count(tile - body_of(tile).first_tile); }
    Box3d patch_bounds(PatchId patch) const override
    {
        const Body& body = body_of(patch.tile);
        return body.patches->patch_bounds({patch.tile - body.first_tile, patch.index});
    }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        const Body& body = body_of(patch.tile);
        if (!body.patches->intersect({patch.tile - body.first_tile, patch.index}, ray, hit)) return false;
        hit.patch = patch;
        return true;
    }
    bool occluded(PatchId patch, const Ray& ray) const override
    {
        const Body& body = body_of(patch.tile);
        return body.patches->occluded({patch.tile - body.first_tile, patch.index}, ray);
    }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = crossing_at(ray, hit, accuracy_);
        const auto part = static_cast<std::size_t>(&body_of(hit.patch.tile) - bodies_.data());
        at.geometric_normal = part == 0   ? field_.wall().gradient(at.position)
                              : part == 1 ? field_.plateau_gradient(at.position)
                                          : field_.floor_gradient(at.position);
        if (!(at.geometric_normal.length() > 1e-12)) at.geometric_normal = Vec3d(0, 0, 1);
        at.geometric_normal.normalize();
        paint(part, at);
        at.spawn_offset = offset_into_air(at, size_, flat_, [&](const Vec3d& p) { return field_.value(p); });
        return at;
    }

    void dress(Interaction& at) const override
    {
        const double top = std::abs(field_.plateau(at.position)), ground = std::abs(field_.floor(at.position));
        const double wall = std::abs(field_.wall().value(at.position));
        paint(ground <= std::min(top, wall) ? 2 : top <= wall ? 1 : 0, at);
    }

    bool contains(const Vec3d& p) const override { return field_.value(p) <= 0.0; }
    std::vector<std::string> materials() const override { return {"bedrock", "plateau", "sand"}; }
    bool closed() const override { return false; }
    const Field* field() const override { return &field_; }

    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        for (const Body& body : bodies_) {
            info.trace_bytes += body.patches->memory_bytes();
            for (std::uint32_t t = 0; t < body.patches->tile_count(); ++t) info.patches += body.patches->patch_count(t);
        }
        info.build_seconds = build_seconds_;
        return info;
    }

private:
    /// Parts overlap by this share of a cell at their edges.
    static constexpr double kHair = 1e-8;
    struct Body {
        std::unique_ptr<PartField> field;
        std::unique_ptr<const FieldIntersector> patches;
        std::uint32_t first_tile = 0;
    };

    const Body& body_of(std::uint32_t tile) const
    {
        std::size_t b = bodies_.size() - 1;
        while (bodies_[b].first_tile > tile) --b;
        return bodies_[b];
    }

    /// Walls show the deposit at their foot as sand.
    void paint(std::size_t part, Interaction& at) const
    {
        at.shading_normal = at.geometric_normal;
        // Layers of the look are lifted with the rock.
        at.texture_point = at.position;
        if (part != 2) at.texture_point.z -= CanyonLift::at(field_.shape(), at.position).value;
        const Vec3d from = at.position - field_.shape().origin;
        // Of the undeformed plan (section 3.2): a map sticks to the rock however far its walls have moved.
        const Vec3d rest = (part == 0 ? field_.wall().inverse(at.position) : at.position) - field_.shape().origin;
        at.uv = Vec2d(rest.x, rest.y) * (1.0 / field_.shape().cell);
        if (part > 0) {
            at.materials.add(static_cast<std::uint8_t>(part), 1.0f);
            return;
        }
        const double z = from.z / field_.shape().height, below = (field_.shape().sediment_height - z) / 0.1;
        const auto sand = static_cast<float>(field_.shape().sediment > 0.0 ? std::clamp(below, 0.0, 1.0) : 0.0);
        if (sand < 1.0f) at.materials.add(0, 1.0f - sand);
        if (sand > 0.0f) at.materials.add(2, sand);
    }

    CanyonField field_;
    std::array<Body, 3> bodies_;
    std::uint32_t tiles_ = 0;
    double accuracy_, flat_, size_;
    double build_seconds_ = 0.0;
};

CanyonShape shape_of(const Values& values, const BuildContext& context)
{
    CanyonShape shape;
    shape.origin = values.vec3("origin");
    shape.cell = values.number("cell");
    shape.height = values.number("height");
    shape.seed = static_cast<std::uint32_t>(hash_name(context.seed, "plan") >> 32);
    shape.profile_seed = static_cast<std::uint32_t>(hash_name(context.seed, "profile") >> 32);
    shape.amplitude = values.number("amplitude");
    shape.frequency = values.number("frequency");
    shape.octaves = static_cast<int>(values.integer("octaves"));
    shape.sediment = values.number("sediment");
    shape.sediment_height = values.number("sediment_height");
    shape.floor_amplitude = values.number("floor");
    shape.floor_wavelength = values.number("floor_wavelength");
    shape.lift = values.number("lift");
    shape.lift_wavelength = values.number("lift_wavelength");
    if (values.boolean("lod") && context.view) shape.view = DetailView{context.view->eye, context.view->spread, 0.0};
    return shape;
}

Shape make_canyon(const Values& values, const BuildContext& context)
{
    const auto start = std::chrono::steady_clock::now();
    const CanyonShape shape = shape_of(values, context);
    const std::string why_not = Warp::why_not(*noise_gradient_flow(shape.origin, shape.cell, shape.seed), CanyonProfile(shape).most() * shape.cell);
    if (!why_not.empty()) throw values.problem("amplitude", why_not, "walls that move less");
    const Vec3d centre = values.has("centre") ? values.vec3("centre") : context.view ? context.view->eye : shape.origin;
    const double extent = values.number("extent");
    PatchSettings settings;
    settings.domain = Box3d(Vec3d(centre.x - extent, centre.y - extent, shape.origin.z - 1e-3 * shape.height),
                            Vec3d(centre.x + extent, centre.y + extent, shape.origin.z + shape.height * 1.001 + CanyonLift::bound(shape).value));
    settings.size = values.has("patch") ? values.number("patch") : shape.cell / 10.0;
    settings.focus = centre;
    settings.growth = values.number("growth");
    read_search(values, settings);
    settings.epsilon_distance = shape.cell;
    settings.accuracy = 1e-7 * shape.cell;
    if (context.progress) context.progress(0.1, "patches");
    auto surface = std::make_unique<CanyonSurface>(shape, settings);
    surface->set_build_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return surface;
}

Parameter share(const std::string& name, const std::string& doc, double fallback, double most)
{
    return {.name = name, .type = ParameterType::number, .doc = doc, .fallback = fallback, .minimum = 0, .maximum = most};
}

Parameter metres(const std::string& name, const std::string& doc, double fallback)
{
    return {.name = name, .type = ParameterType::length, .doc = doc, .fallback = fallback, .unit = "m", .minimum = 0, .above_minimum = true};
}

}  // namespace

CatalogueEntry canyon_row()
{
    Schema schema{"canyon", "Canyons of a noise, their walls moved along its gradient layer by layer; without end.", {}};
    schema.parameters = {
        {.name = "origin",
         .type = ParameterType::vector,
         .doc = "A corner of the noise's lattice, at height 0.",
         .fallback = std::vector<double>{0, 0, 0},
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        metres("cell", "Side of the noise's cells: about the distance from canyon to canyon.", 50.0),
        metres("height", "From height 0 to the plateau.", 40.0),
        share("amplitude", "How far walls move: of T, in squared cells.", 0.35, 2.0),
        share("frequency", "Cells of T's first octave from bottom to plateau.", 3.0, 64.0),
        {.name = "octaves",
         .type = ParameterType::integer,
         .doc = "Octaves of T: layers of rock within layers.",
         .fallback = std::int64_t{6},
         .minimum = 1,
         .maximum = 12},
        share("sediment", "Slope of the deposit at the foot of the walls; 0: none.", 0.35, 10.0),
        share("sediment_height", "Its upper end, a share of the height.", 0.3, 1.0),
        share("floor", "Roughness of the floor, a share of the height.", 0.04, 0.4),
        {.name = "floor_wavelength",
         .type = ParameterType::number,
         .doc = "Its wavelength.",
         .fallback = 0.7,
         .unit = "cell",
         .minimum = 0.01,
         .maximum = 100},
        share("lift", "How far layers and plateau are lifted and lowered by a noise of the plan, from lowest to highest, a share of the height.", 0.0,
              0.5),
        {.name = "lift_wavelength",
         .type = ParameterType::number,
         .doc = "Wavelength of that noise.",
         .fallback = 2.0,
         .unit = "cell",
         .minimum = 0.5,
         .maximum = 100},
        {.name = "lod",
         .type = ParameterType::boolean,
         .doc = "Fades out octaves that a pixel does not resolve, by the distance from the eye.",
         .fallback = true},
        {.name = "centre",
         .type = ParameterType::vector,
         .doc = "Middle of what is traced; by default the eye.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        metres("extent", "Half the side of the square that is traced.", 1000.0),
        {.name = "patch",
         .type = ParameterType::length,
         .doc = "Side of the boxes that rays are tested against, near the centre; by default a tenth of the cell.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "growth",
         .type = ParameterType::number,
         .doc = "How much larger boxes are a metre of distance from the centre.",
         .fallback = 0.03,
         .minimum = 0,
         .maximum = 1},
    };
    for (Parameter& p : search_parameters("the walls", 1.0)) schema.parameters.push_back(std::move(p));
    return {"canyon", "Gamito2001", std::move(schema), make_canyon};
}

}  // namespace hoodoo
