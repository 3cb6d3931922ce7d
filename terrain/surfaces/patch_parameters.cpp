// The search itself is the scene's choice, because the paper's (Gamito2001, section 3.1) is kept to be compared with.
#include "terrain/surfaces/patch_parameters.h"

namespace hoodoo
{

std::vector<Parameter> search_parameters(const std::string& where, double epsilon)
{
    return {
        {.name = "mode",
         .type = ParameterType::choice,
         .doc = "certified: no crossing is missed; paper: the area test of Gamito and Musgrave, to compare.",
         .fallback = std::string("certified"),
         .choices = {"certified", "paper"}},
        {.name = "epsilon",
         .type = ParameterType::number,
         .doc = "Paper mode: largest area of a triangle of the warped ray, at " + where + ".",
         .fallback = epsilon,
         .unit = "m2",
         .minimum = 0,
         .above_minimum = true},
    };
}

void read_search(const Values& values, PatchSettings& settings)
{
    settings.mode = values.text("mode") == "paper" ? MarchMode::paper : MarchMode::certified;
    settings.epsilon = values.number("epsilon");
}

}  // namespace hoodoo
