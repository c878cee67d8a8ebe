// Which program this is.
#pragma once

namespace softarm::app::batch {

/// "0.1.0": results of another one do not go into the same table.
const char* program_version();

}  // namespace softarm::app::batch
