// Payloads that are not what was told.
#pragma once

#include <string>
#include <vector>

#include "payload_search.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// The trials under these payloads; about a change that was found nothing is compared.
std::vector<model::TrialData> under(const std::vector<OtherPayload>& payloads,
                                    std::vector<model::TrialData> trials);

/// In the order of the trials. @param trials as they were told
ToldPayloads told_payloads(const std::vector<OtherPayload>& payloads,
                           const std::vector<model::TrialData>& trials);

/// In a few sentences: what hung there, and how sure that is.
std::string found_instead(const ToldPayloads& payloads);

/// The same, and what is to be done.
std::string sentence_of(const ToldPayloads& payloads);

}  // namespace softarm::diagnose
