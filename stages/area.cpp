// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/area.h"

namespace swath::stages {

void set_area(Context& context, const Box& places, double margin) {
  const io::SurveyArea& stated = context.survey.area;
  const Box box = places.grown(margin);
  const auto side = [&](const std::optional<double>& v, double otherwise) { return v ? *v * context.unit : otherwise; };
  context.area.box = {side(stated.west, box.x0), side(stated.south, box.y0), side(stated.east, box.x1), side(stated.north, box.y1)};
  if (stated.lowest) context.area.lowest = stated.lowest->value;
  if (stated.highest) context.area.highest = stated.highest->value;
}

}  // namespace swath::stages
