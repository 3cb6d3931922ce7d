// The catalogue's row of layer stacks under a kernel: what a scene may say about one (Peytavie2009; the surface is in convolution.cpp).

#include "terrain/surfaces/convolution.h"
#include "terrain/surfaces/rock_source.h"
#include "terrain/surfaces/rows.h"
#include "terrain/surfaces/stack_source.h"

namespace hoodoo
{

CatalogueEntry convolution_row()
{
    Schema schema{"convolution", "Layers of material under a smoothing kernel: cliffs, overhangs, arches and caves.", stack_parameters()};
    const std::vector<Parameter> own = {
        {.name = "materials",
         .type = ParameterType::names,
         .doc = "What is ground: one smooth body.",
         .fallback = std::vector<std::string>{"sand", "bedrock", "soil"},
         .choices = {"water", "sand", "bedrock", "rock", "soil"},
         .min_count = 1,
         .max_count = 5},
        {.name = "rocks",
         .type = ParameterType::choice,
         .doc = "Rock layers: single rocks that touch, a smooth surface of their own, part of the ground, or not traced.",
         .fallback = std::string("instances"),
         .choices = {"instances", "surface", "ground", "hidden"}},
        {.name = "water",
         .type = ParameterType::choice,
         .doc = "Water layers: a flat surface of their own, or not traced.",
         .fallback = std::string("surface"),
         .choices = {"surface", "hidden"}},
        {.name = "border",
         .type = ParameterType::choice,
         .doc = "Edge columns go on for ever, or the block is cut out with walls and a bottom.",
         .fallback = std::string("extend"),
         .choices = {"extend", "cut"}},
        {.name = "base",
         .type = ParameterType::length,
         .doc = "Thickness of a cut block below the datum; 2 sigma by default.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "intersector",
         .type = ParameterType::choice,
         .doc = "exact: closed form, needs 2 sigma a multiple of the cell; sphere: any sigma, less memory; auto: exact where possible.",
         .fallback = std::string("auto"),
         .choices = {"auto", "exact", "sphere"}},
        {.name = "normal_width",
         .type = ParameterType::number,
         .doc = "Half-width of the differences that give shading normals.",
         .fallback = 0.75,
         .unit = "cell",
         .minimum = 0.01,
         .maximum = 8},
    };
    for (Parameter& p : rock_parameters(0.0)) schema.parameters.push_back(std::move(p));
    schema.parameters.insert(schema.parameters.end(), own.begin(), own.end());
    return {"convolution", "Peytavie2009", std::move(schema), make_convolution, make_stack};
}

}  // namespace hoodoo
