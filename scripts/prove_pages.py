"""The pages of the proof with their pictures, beside one another: the story, every case, and what was missed."""
import os

import prove_misses
import prove_real_report
import prove_report
from prove_files import say, write_text


def pictures(results, stem):
    """Draws them; file names of "calibration", "real" and "misses" (by world), of those that there are."""
    try:
        import prove_picture
    except ImportError as missing:
        say(f"no pictures: {missing} (apt-get install python3-matplotlib)")
        return {"misses": {}}
    drawn = {"calibration": stem + "_calibration.png", "real": stem + "_real.png"}
    prove_picture.draw(results, drawn["calibration"])
    if not prove_real_report.draw(results, drawn["real"]):
        del drawn["real"]
    misses = prove_misses.draw_all(results, stem)
    for path in (*drawn.values(), *misses.values()):
        say(f"written: {path}")
    return {**{name: os.path.basename(path) for name, path in drawn.items()},
            "misses": {world: os.path.basename(path) for world, path in misses.items()}}


def write(results, figures, story):
    """story: path of the page that leads to the others."""
    stem = os.path.splitext(story)[0]
    own = os.path.basename(stem)
    names = {**pictures(results, stem), "story": os.path.basename(story), "trials_page": own + "_trials.md", "misses_page": own + "_misses.md"}
    for name, text in ((names["story"], prove_report.story(results, figures, names)),
                       (names["trials_page"], prove_report.trials(results, figures, names)),
                       (names["misses_page"], prove_misses.story(results, figures, names))):
        path = os.path.join(os.path.dirname(story), name)
        write_text(path, text)
        say(f"written: {path}")
