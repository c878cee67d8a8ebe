// What is fed with bytes that may be anything: each target is one way by which files and messages come in. It
// refuses them in the ways that its reader documents; anything else, a signal among them, is a finding.
#pragma once

#include <cstddef>
#include <cstdint>

namespace softarm::fuzz {

/// A bag: looked through, then read as `check` and as `estimate` do.
void bag(const std::uint8_t* data, std::size_t size);
/// An arm file, with the effects that it names.
void arm(const std::uint8_t* data, std::size_t size);
/// A scenario of the rig.
void scenario(const std::uint8_t* data, std::size_t size);
/// A layout and a CSV recording, and its inputs file where there is a third part: divided by lines of `---`.
void csv(const std::uint8_t* data, std::size_t size);
/// A message of a driver or an input, as a bag or a publisher hands it on. First byte: which of the arms,
/// second: which of its topics; of a type that is not built in, the definition goes before, ended by a 0;
/// without one, a driver's mirror is meant.
void message(const std::uint8_t* data, std::size_t size);

}  // namespace softarm::fuzz
