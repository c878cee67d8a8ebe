"""Pictures of the finite-element arm as CalculiX has it: skin, chambers cut open, markers; used by solid_arm.py --picture."""
import numpy as np

import solid_arm
import solid_deck

SHOWN = [("hanging", 0.0, (40000.0, 0.0, 0.0)), ("horizontal", 0.06, (0.0, 0.0, 0.0)), ("horizontal", 0.06, (26400.0, 20500.0, 0.0)),
         ("standing", 0.06, (0.0, 5400.0, 38600.0))]
FACES = {1: (0, 1, 2, 3), 2: (4, 5, 6, 7), 3: (0, 1, 5, 4), 4: (1, 2, 6, 5), 5: (2, 3, 7, 6), 6: (3, 0, 4, 7)}


def outside(mesh):
    """Faces (corner nodes) that no other brick shares and no chamber has."""
    inner = {(brick, face) for faces in mesh.faces for brick, face in faces}
    seen = {}
    for number, brick in enumerate(mesh.bricks):
        for face, corners in FACES.items():
            seen.setdefault(frozenset(brick[list(corners)]), []).append((number, face))
    return [mesh.bricks[where[0][0]][list(FACES[where[0][1]])] for where in seen.values() if len(where) == 1 and where[0] not in inner]


def inside(mesh):
    return [mesh.bricks[brick][list(FACES[face])] for faces in mesh.faces for brick, face in faces]


def deformed(plan, work):
    """Nodes of the arm in the room, for each state that is shown."""
    import solid_trials
    arm = solid_arm.arm_of(plan, "nothing")
    mesh = solid_arm.mesh_of(arm, plan["planes_m"])
    used = np.unique(mesh.bricks)
    for attitude, payload, pressures in SHOWN:
        deck = solid_deck.Deck(mesh, arm)
        deck.add_steps([[0.0] * 3] + [list(pressures)] * (max(pressures) > 0), plan["attitudes"][attitude], payload, used)
        moved, _ = solid_deck.solve(deck, work, "picture")
        places = np.full((len(mesh.nodes), 3), np.nan)
        places[used] = mesh.nodes[used] + moved[-1]
        turn = solid_trials.attitude(attitude, plan["attitudes"][attitude])
        yield mesh, (attitude, payload, pressures), mesh.nodes @ turn.T, places @ turn.T


def draw(plan, work, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection
    figure = plt.figure(figsize=(13, 4))
    for number, (mesh, (attitude, payload, pressures), rest, places) in enumerate(deformed(plan, work)):
        axes = figure.add_subplot(1, len(SHOWN), number + 1, projection="3d")
        for faces, colour, alpha in ((outside(mesh), "#9ecae1", 0.25), (inside(mesh), "#d9730d", 0.35)):
            axes.add_collection3d(Poly3DCollection([1e3 * places[face] for face in faces], facecolor=colour, edgecolor="#444444",
                                                   linewidth=0.25, alpha=alpha))
        marks = np.concatenate(list(solid_arm.clusters_of(mesh, plan).values()))
        axes.scatter(*(1e3 * places[marks]).T, color="k", s=9, depthshade=False)
        axis = 1e3 * rest[[mesh.plane(0)[0], mesh.plane(len(mesh.heights) - 1)[0]]]
        axes.plot(*axis.T, color="#999999", ls=":", lw=1)
        seen = 1e3 * places[~np.isnan(places[:, 0])]
        middle, reach = (seen.max(axis=0) + seen.min(axis=0)) / 2, 105
        for limits, centre in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle):
            limits(centre - reach, centre + reach)
        axes.set_box_aspect((1, 1, 1), zoom=1.25)
        axes.view_init(elev=12, azim=-70)
        axes.set_title(f"{attitude}, {1e3 * payload:.0f} g\n" + " / ".join(f"{p / 1e3:.0f}" for p in pressures) + " kPa", fontsize=10)
        axes.tick_params(labelsize=6, pad=-2)
        axes.locator_params(nbins=4)
    figure.subplots_adjust(left=0.01, right=0.98, bottom=0.03, top=0.88, wspace=0.08)
    figure.savefig(path, dpi=85)
