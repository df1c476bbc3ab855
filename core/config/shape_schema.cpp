// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/shape_schema.h"

namespace swath::core {

Value shape_schema(const Shape& shape) {
  Value out = Value::object();
  switch (shape.kind) {
    case Kind::boolean:
      out["type"] = "boolean";
      break;
    case Kind::integer:
      out["type"] = "integer";
      break;
    case Kind::number:
    case Kind::quantity:
      out["type"] = "number";
      break;
    case Kind::text:
    case Kind::path:
      out["type"] = "string";
      break;
    case Kind::choice:
      out["enum"] = Value::array();
      for (const std::string& c : shape.choices) out["enum"].push(c);
  }
  return out;
}

}  // namespace swath::core
