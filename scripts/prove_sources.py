"""Where the cases of the proof come from: one module per source, chosen by --worlds and --campaign.

A source is a class with

    name                       what the report calls it; two sources have different ones
    absent()                   None; or why it cannot be drawn from here, in one line: it is then skipped by that line
    kinds()                    names of its kinds of case. No two sources have the same; prove_score.py says what counts for each
    plan(kinds)                [(kind, number)] for options.full, options.cases and these kinds: every case, in any order.
                               It draws nothing, and the same options give the same list
    draw(kind, number, case, truth)
                               makes one case, all of it from options.seed, kind and number; raises prove_files.NotDrawn with
                               one line where it cannot be made, and why each of its draws did not do. It leaves both folders, or neither (write beside, rename)
    again(kind, number, case, truth)
                               makes the folder `case` of a case that was drawn elsewhere again, by its truth

`case` is what a laboratory would have: bags, arm file, and case.json {"arm": file or name of one in config/arms, "trials":
[bags], "options": [more words for `softarm diagnose` and `prove decide`, such as --tie]}; paths are relative to the folder.
`truth` is sealed before the first diagnosis. Its case.json has {"kind", "effects", "distractors", "ideal", "constants",
"rejected": [why earlier draws of this case did not do]}, as `prove draw` writes it, and what the kind's own scores need;
displacement.json, where there is one, has by effect how far it moves the bodies (prove_displacement.py).
Whoever runs sources: prove_cases.py, which names cases, shuffles, seals, diagnoses and scores.
"""
import sys

import prove_real
import prove_rig
import prove_solid

WORLDS = ("tidy", "untidy", "solid", "real")


def chosen(options):
    """The sources for --worlds and --campaign. A campaign alone is a world of its own; no --worlds: all that are there."""
    named = options.worlds.split(",") if options.worlds else [] if options.campaign else list(WORLDS)
    unknown = [name for name in named if name not in WORLDS]
    if unknown:
        sys.exit(f"prove: --worlds: no world {', '.join(unknown)}; there are {', '.join(WORLDS)}")
    campaigns = [prove_rig.CAMPAIGNS[name] for name in named if name in prove_rig.CAMPAIGNS]
    if options.campaign:
        campaigns = [options.campaign]
    sources = [prove_rig.Source(options, name) for name in campaigns]
    if "solid" in named:
        sources.append(prove_solid.Source(options))
    if "real" in named:
        sources.append(prove_real.Source(options))
    return sources
