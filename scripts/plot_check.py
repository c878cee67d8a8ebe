#!/usr/bin/python3
"""Draws what `softarm check` finds: one row per body and input, marked where something is wrong, and the levels at rest.

    scripts/plot_check.py --arm online_200mm trial.bag --out findings.png
    scripts/plot_check.py findings.json --out findings.png                  # what softarm check --json wrote

It needs python3-matplotlib; for bags it also needs the module softarm (scripts/python builds it).
"""
import argparse
import json
import sys

from plotting import die, plt, save

COLOURS = {'serious': '#c0392b', 'warning': '#e69f00', 'information': '#9fb8cc'}


def rows_of(recording):
    """Bodies, then inputs, then what belongs to no stream."""
    names = [stream['name'] for stream in recording['streams']]
    others = []
    for finding in recording['findings']:
        if not any(name in names for name in finding['where'].split(', ')):
            others.append(finding['where'] or 'recording')
    return names + sorted(set(others))


def draw_timeline(axes, recording):
    rows = rows_of(recording)
    end = max(recording['duration_s'], 0.1)
    for i in range(len(rows)):
        axes.barh(i, end, height=0.7, color='#f0f2f4', zorder=0)
    notes = {}
    # The most serious are drawn last, on top.
    for finding in reversed(recording['findings']):
        if finding['severity'] == 'information':
            continue
        colour = COLOURS[finding['severity']]
        for name in finding['where'].split(', '):
            row = rows.index(name if name in rows else finding['where'] or 'recording')
            if not finding['spans_s']:
                axes.barh(row, end, height=0.16, color=colour, zorder=1)
            for begin, until in finding['spans_s']:
                width = max(until - begin, 0.004 * end)
                axes.barh(row, width, left=begin, height=0.7, color=colour, alpha=0.85, zorder=2)
            if finding['id'] not in notes.setdefault(row, []):
                notes[row].append(finding['id'])
    for row, ids in notes.items():
        axes.text(1.01 * end, row, ', '.join(reversed(ids)), va='center', fontsize=7).set_in_layout(False)
    axes.set_yticks(range(len(rows)))
    axes.set_yticklabels(rows, fontsize=8)
    axes.invert_yaxis()
    axes.set_xlim(0, end)
    axes.set_xlabel('time, s')
    axes.set_title(recording['name'].split('/')[-1], fontsize=9, loc='left')


def draw_levels(axes, recording):
    levels = [(s['name'], s['rest_level']) for s in recording['streams'] if 'rest_level' in s]
    axes.set_title('inputs at rest', fontsize=9, loc='left')
    if not levels:
        axes.text(0.5, 0.5, 'no rest seen', ha='center', va='center', transform=axes.transAxes)
        axes.set_axis_off()
        return
    names, values = zip(*levels)
    off = {f['where'] for f in recording['findings'] if f['id'] == 'offset_at_rest' and f['severity'] != 'information'}
    scale, unit = (1e-3, 'kPa') if max(abs(v) for v in values) > 100 else (1.0, 'Pa, N or rad')
    axes.barh(range(len(names)), [scale * v for v in values],
              color=[COLOURS['warning'] if n in off else COLOURS['information'] for n in names])
    axes.axvline(0, color='black', linewidth=0.8)
    axes.set_yticks(range(len(names)))
    axes.set_yticklabels(names, fontsize=8)
    axes.invert_yaxis()
    axes.set_xlabel(unit)


def draw(recordings):
    heights = [0.6 + 0.28 * len(rows_of(r)) for r in recordings]
    figure, axes = plt.subplots(len(recordings), 2, figsize=(12, sum(heights) + 0.6 * len(recordings)), squeeze=False,
                                gridspec_kw={'width_ratios': [3, 1], 'height_ratios': heights})
    for row, recording in zip(axes, recordings):
        draw_timeline(row[0], recording)
        draw_levels(row[1], recording)
    # Names of findings stand in the gap.
    figure.tight_layout()
    figure.subplots_adjust(wspace=1.15)
    return figure


def checked(arm, bags):
    from softarm_module import softarm
    try:
        return softarm.check(softarm.load_arm(arm), bags).to_dict()['recordings']
    except (softarm.Error, ValueError) as why:
        die(why)


def written(files):
    recordings = []
    for path in files:
        try:
            with open(path, encoding='utf-8') as file:
                recordings += json.load(file)['recordings']
        except OSError as error:
            die(f'{path}: {error.strerror}')
        except (ValueError, KeyError, TypeError) as error:
            sys.exit(f'{path}: not the findings of softarm check ({error}); for bags, --arm gives their arm')
    if not recordings:
        sys.exit(f"{', '.join(files)}: findings of no recording")
    return recordings


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('findings', nargs='+', help='files written by softarm check --json; with --arm: bags')
    parser.add_argument('--arm', help='arm file, or the name of one that ships')
    parser.add_argument('--out', required=True, help='picture to write (png, pdf, svg)')
    options = parser.parse_args()
    recordings = checked(options.arm, options.findings) if options.arm else written(options.findings)
    try:
        figure = draw(recordings)
    except (KeyError, TypeError, ValueError, AttributeError) as why:
        sys.exit(f"{', '.join(options.findings)}: not the findings of softarm check ({why})")
    save(figure, options.out, dpi=120)


if __name__ == '__main__':
    main()
