// The rows of the tools' table: one function each, defined in terrain/edit/NAME.cpp.
#pragma once

#include "terrain/edit/tools.h"

namespace hoodoo
{

EditTool sculpt_tool();
EditTool sweep_tool();
EditTool deposit_tool();
EditTool erode_tool();
EditTool fill_tool();
EditTool stabilise_tool();
EditTool crack_tool();

}  // namespace hoodoo
