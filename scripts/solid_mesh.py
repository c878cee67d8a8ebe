"""Mesh of the finite-element arm: its cross-section by gmsh in quadrilaterals, drawn out to bricks; used by solid_arm.py."""
import dataclasses
import math

import numpy as np

# Faces of a brick (CalculiX): the number of the face, and which of its lower corners bound it.
SIDES = {3: (0, 1), 4: (1, 2), 5: (2, 3), 6: (3, 0)}


@dataclasses.dataclass
class Chamber:
    radius_m: float
    offset_m: float      # of its axis from the arm's
    azimuth_rad: float   # where it lies

    def centre(self):
        return self.offset_m * np.array([math.cos(self.azimuth_rad), math.sin(self.azimuth_rad)])


@dataclasses.dataclass
class Section:
    points: np.ndarray   # n x 2
    quads: np.ndarray    # m x 4, counter-clockwise
    hole: np.ndarray     # of each quadrilateral: the number of its chamber, or -1
    rim: list            # points of the arm's skin
    rings: list          # of each chamber: its points, in order
    middles: dict        # of each edge (its two points): the point in its middle


@dataclasses.dataclass
class Mesh:
    nodes: np.ndarray    # n x 3
    bricks: np.ndarray   # m x 20
    layer: np.ndarray    # of each brick: number of its layer from the base
    heights: np.ndarray  # of the planes between layers, m
    faces: list          # of each chamber: (brick, face) that its pressure pushes on
    hoops: np.ndarray    # k x 2, nodes that a thread joins
    section: Section

    def plane(self, number):
        """Nodes of a plane between layers, in the section's order; some may be of no brick."""
        count = len(self.section.points)
        return np.arange(2 * number * count, (2 * number + 1) * count)

    def nearest_plane(self, height_m):
        return int(np.argmin(np.abs(self.heights - height_m)))


def half_sector(radius_m, chamber_radius_m, offset_m, halvings):
    """A sixth of the section, from a chamber's middle to the plane half-way to the next, by gmsh (algorithm 8 crashes in
    Debian's version, and so does full-quad recombination; with these numbers of edges plain recombination leaves no
    triangles). Returns points and the quadrilaterals of wall and chamber."""
    import gmsh
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.Algorithm", 6)
        gmsh.option.setNumber("Mesh.RecombineAll", 1)
        geo = gmsh.model.geo
        centre, middle = geo.addPoint(0, 0, 0), geo.addPoint(offset_m, 0, 0)
        near, far = (geo.addPoint(offset_m + side * chamber_radius_m, 0, 0) for side in (-1, 1))
        skin = geo.addPoint(radius_m, 0, 0)
        corner = geo.addPoint(radius_m * math.cos(math.pi / 3), radius_m * math.sin(math.pi / 3), 0)
        inner, outer, across = geo.addLine(centre, near), geo.addLine(far, skin), geo.addLine(far, near)
        top = geo.addPoint(offset_m, chamber_radius_m, 0)
        arcs = [geo.addCircleArc(near, middle, top), geo.addCircleArc(top, middle, far)]
        rim, spoke = geo.addCircleArc(skin, centre, corner), geo.addLine(corner, centre)
        for curve, edges in ((inner, 1), (arcs[0], 2), (arcs[1], 2), (outer, 1), (rim, 2), (spoke, 2), (across, 2)):
            geo.mesh.setTransfiniteCurve(curve, edges + 1)
        surfaces = [geo.addPlaneSurface([geo.addCurveLoop([inner, *arcs, outer, rim, spoke])]),
                    geo.addPlaneSurface([geo.addCurveLoop([*arcs, across])])]
        geo.synchronize()
        gmsh.model.mesh.generate(2)
        for _ in range(halvings):
            gmsh.model.mesh.refine()
        tags, flat, _ = gmsh.model.mesh.getNodes()
        at = dict(zip(tags, np.array(flat).reshape(-1, 3)[:, :2]))
        quads = []
        for surface in surfaces:
            kinds, _, corners = gmsh.model.mesh.getElements(2, surface)
            if list(kinds) != [3]:
                raise RuntimeError("gmsh left triangles in the section")
            quads.append(np.array([[at[tag] for tag in quad] for quad in np.array(corners[0]).reshape(-1, 4)]))
    finally:
        gmsh.finalize()
    return quads


def counter_clockwise(corners):
    a, b = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    flipped = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0
    corners[flipped] = corners[flipped][:, ::-1]
    return corners


def section(radius_m, chambers, halvings=0):
    """Meshes the section, halving its edges so many times; on circles the middles of edges, too, lie on them. It looks the same
    from every chamber, so that the mesh makes no direction stiffer than another. Chambers that are smaller than the
    first are drawn in afterwards."""
    largest = max(chambers, key=lambda chamber: chamber.radius_m)
    pieces = half_sector(radius_m, largest.radius_m, largest.offset_m, halvings)
    corners, hole = [], []
    for which, chamber in enumerate(chambers):
        c, s = math.cos(chamber.azimuth_rad), math.sin(chamber.azimuth_rad)
        for mirror in (1, -1):
            turn = np.array([[c, -s], [s, c]]) @ np.diag([1, mirror])
            for kind, piece in enumerate(pieces):
                corners.append(piece @ turn.T)
                hole += [which if kind else -1] * len(piece)
    corners = counter_clockwise(np.concatenate(corners))
    keys, points, quads = {}, [], []
    for quad in corners:
        quads.append([])
        for point in quad:
            key = tuple(np.round(point * 1e7).astype(int) // 10)
            near = next((k for k in ((key[0] + i, key[1] + j) for i in (0, -1, 1) for j in (0, -1, 1)) if k in keys), key)
            if near not in keys:
                keys[near] = len(points)
                points.append(point)
            quads[-1].append(keys[near])
    points, quads, hole = np.array(points), np.array(quads), np.array(hole)
    on_rim = np.flatnonzero(np.abs(np.linalg.norm(points, axis=1) - radius_m) < 0.01 * radius_m)
    rings = [on_rim]
    for which in range(len(chambers)):
        wall = set(quads[(hole < 0)].ravel())
        rings.append(np.array(sorted(wall & set(quads[hole == which].ravel()))))
    centres = [np.zeros(2)] + [chamber.centre() for chamber in chambers]
    sizes = [radius_m] + [chamber.radius_m for chamber in chambers]
    for ring, centre, size in zip(rings, centres, sizes):
        out = points[ring] - centre
        points[ring] = centre + size * out / np.linalg.norm(out, axis=1, keepdims=True)
    for which, chamber in enumerate(chambers):
        inside = np.array(sorted(set(quads[hole == which].ravel()) - set(rings[which + 1])), dtype=int)
        points[inside] = centres[which + 1] + (points[inside] - centres[which + 1]) * chamber.radius_m / largest.radius_m
    ordered = [sorted(ring, key=lambda n, c=centre: math.atan2(*(points[n] - c)[::-1])) for ring, centre in zip(rings, centres)]
    return with_middles(Section(points, quads, hole, ordered[0], ordered[1:], {}), centres, sizes)


def with_middles(cut, centres, sizes):
    """Adds the middles of all edges to the points; those of a circle's edges lie on it."""
    middles, points = {}, []
    for quad in cut.quads:
        for i in range(4):
            edge = frozenset((quad[i], quad[(i + 1) % 4]))
            if edge not in middles:
                middles[edge] = len(cut.points) + len(points)
                points.append(cut.points[list(edge)].mean(axis=0))
    points = np.concatenate([cut.points, points])
    for ring, centre, size in zip([cut.rim] + cut.rings, centres, sizes):
        for edge in edges_of(ring):
            out = points[middles[edge]] - centre
            points[middles[edge]] = centre + size * out / np.linalg.norm(out)
    return dataclasses.replace(cut, points=points, middles=middles)


def edges_of(ring):
    return [frozenset((ring[i - 1], ring[i])) for i in range(len(ring))]


def brick(cut, quad, low, middle, high):
    """Nodes of a brick of 20 (CalculiX, C3D20R) whose floor is this quadrilateral; low, middle and high: first node of its
    floor's, its middle's and its ceiling's plane."""
    around = [cut.middles[frozenset((quad[i], quad[(i + 1) % 4]))] for i in range(4)]
    return [*(quad + low), *(quad + high), *(np.array(around) + low), *(np.array(around) + high), *(quad + middle)]


def drawn_out(cut, heights, is_cap):
    """Bricks between the planes at these heights; where is_cap says so of a layer, the chambers are full."""
    count = len(cut.points)
    planes = [z for i, height in enumerate(heights) for z in ([height] if i == 0 else [(heights[i - 1] + height) / 2, height])]
    nodes = np.array([[*point, z] for z in planes for point in cut.points])
    bricks, layers, faces, hoops = [], [], [[] for _ in cut.rings], []
    is_open = [not is_cap(layer) for layer in range(len(heights) - 1)]
    walls = [set(edges_of(ring)) for ring in cut.rings]
    for layer, here in enumerate(is_open):
        first = 2 * layer * count
        for quad, hole in zip(cut.quads, cut.hole):
            if hole >= 0 and here:
                continue
            number = len(bricks)
            bricks.append(brick(cut, quad, first, first + count, first + 2 * count))
            layers.append(layer)
            if hole >= 0:
                # A chamber's floor is the ceiling of the cap below it, and the other way round.
                faces[hole] += [(number, 2)] * (layer + 1 < len(is_open) and is_open[layer + 1])
                faces[hole] += [(number, 1)] * (layer > 0 and is_open[layer - 1])
            elif here:
                for which, wall in enumerate(walls):
                    faces[which] += [(number, side) for side, ends in SIDES.items() if frozenset(quad[list(ends)]) in wall]
    for plane in range(1, len(planes) - 1):
        if is_open[plane // 2] or is_open[(plane - 1) // 2]:
            hoops += [[a + plane * count, b + plane * count] for ring in cut.rings for a, b in thread(cut, ring, plane % 2 == 0)]
    return Mesh(nodes, np.array(bricks), np.array(layers), np.asarray(heights), faces, np.array(hoops).reshape(-1, 2), cut)


def thread(cut, ring, with_middles):
    """Neighbours round a chamber; half-way up a layer of bricks there are no nodes between corners."""
    pairs = []
    for i in range(len(ring)):
        a, b = ring[i - 1], ring[i]
        middle = cut.middles[frozenset((a, b))]
        pairs += [(a, middle), (middle, b)] if with_middles else [(a, b)]
    return pairs
