"""Draws a frame of a running server as a listener sees it: catalogue and states, nothing else.

    in_namespace python picture.py [DEMO [STEPS [FILE.png]]]
"""
import pathlib
import sys
import tempfile

import matplotlib
import numpy as np
from server import SCENES, Server
from wire import APPLIED, TYPES, Wire

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402 (the back end is chosen first)
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # noqa: E402

LIGHT = np.array([-0.45, -0.6, 1.0]) / np.linalg.norm([-0.45, -0.6, 1.0])
LARGEST_FACE = 0.35  # [m] larger faces are cut, so that sorting them by their middle's depth hides the right ones
catalog_t = TYPES["CATALOG"]


def rotation(w, x, y, z):
    """The matrix of a unit quaternion."""
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def box_faces(size):
    """Quadrilaterals of a box with these edges about the origin, none much larger than LARGEST_FACE."""
    half = np.asarray(size) / 2
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        us, vs = (np.linspace(-half[k], half[k], 1 + int(np.ceil(2 * half[k] / LARGEST_FACE))) for k in (u, v))
        for side in (-1, 1):
            for i in range(len(us) - 1):
                for j in range(len(vs) - 1):
                    corners = [(us[i], vs[j]), (us[i + 1], vs[j]), (us[i + 1], vs[j + 1]), (us[i], vs[j + 1])]
                    face = np.empty((4, 3))
                    face[:, axis] = side * half[axis]
                    face[:, [u, v]] = corners if side > 0 else corners[::-1]
                    faces.append(face)
    return faces


def capsule_faces(radius, length, rings=5, sectors=12):
    """Quadrilaterals of a capsule along z; a sphere if the length is 0."""
    latitudes = np.linspace(-np.pi / 2, np.pi / 2, 2 * rings + 2)
    turns = np.linspace(0, 2 * np.pi, sectors + 1)

    def point(latitude, turn):
        return (radius * np.cos(latitude) * np.cos(turn), radius * np.cos(latitude) * np.sin(turn),
                radius * np.sin(latitude) + np.copysign(length / 2, latitude))
    return [np.array([point(a, s), point(a, t), point(b, t), point(b, s)])
            for a, b in zip(latitudes, latitudes[1:]) for s, t in zip(turns, turns[1:])]


def round_faces(radius, length, taper, sectors=16):
    """Sides and caps of a cylinder along z (taper 1), or of a cone with its apex up (taper 0)."""
    turns = np.linspace(0, 2 * np.pi, sectors + 1)
    low = np.column_stack([radius * np.cos(turns), radius * np.sin(turns), np.full(sectors + 1, -length / 2)])
    high = low * (taper, taper, -1)
    sides = [np.array([low[i], low[i + 1], high[i + 1], high[i]]) for i in range(sectors)]
    return sides + [low[:0:-1], high[:-1]][:2 if taper else 1]


def hull_faces(vertices):
    """Triangles of the convex hull."""
    from scipy.spatial import ConvexHull
    points = np.asarray(vertices)
    hull = ConvexHull(points)
    middle = points.mean(axis=0)
    faces = [points[triangle] for triangle in hull.simplices]
    return [face if np.cross(face[1] - face[0], face[2] - face[0]) @ (face[0] - middle) > 0 else face[::-1]
            for face in faces]


def shape_faces(message, i, vertices):
    """Faces of row i of the catalogue's shapes in the shape's frame; none for a half-space."""
    kind = message.shape_type[i]
    size = message.size_x[i], message.size_y[i], message.size_z[i]
    if kind == catalog_t.SHAPE_BOX:
        return box_faces(size)
    if kind in (catalog_t.SHAPE_SPHERE, catalog_t.SHAPE_CAPSULE):
        return capsule_faces(size[0], size[1] if kind == catalog_t.SHAPE_CAPSULE else 0.0)
    if kind in (catalog_t.SHAPE_CYLINDER, catalog_t.SHAPE_CONE):
        return round_faces(size[0], size[1], 1.0 if kind == catalog_t.SHAPE_CYLINDER else 0.0)
    if kind == catalog_t.SHAPE_ELLIPSOID:
        return [face * size for face in capsule_faces(1.0, 0.0)]
    if kind in (catalog_t.SHAPE_HULL, catalog_t.SHAPE_TRIANGLE_MESH, catalog_t.SHAPE_HEIGHT_FIELD):
        return hull_faces(vertices[message.shape_body[i], message.shape_number[i]])
    return []


def collect_faces(wire):
    """All faces in W and their colours."""
    shapes, vertices, poses = {}, {}, {}
    for m in wire.heard["CATALOG"]:
        shapes.update({(m.shape_body[i], m.shape_number[i]): (m, i) for i in range(m.num_shapes)})
        for i in range(m.num_vertices):
            corners = vertices.setdefault((m.vertex_body[i], m.vertex_shape[i]), {})
            corners[m.vertex_number[i]] = (m.vertex_x[i], m.vertex_y[i], m.vertex_z[i])
    vertices = {key: list(corners.values()) for key, corners in vertices.items()}
    for m in wire.heard["STATE"]:
        poses.update({m.id[i]: ((m.px[i], m.py[i], m.pz[i]), (m.qw[i], m.qx[i], m.qy[i], m.qz[i]))
                      for i in range(m.n)})
    faces, colors = [], []
    for (body, _), (m, i) in shapes.items():
        p, q = poses[body]
        turn = rotation(*q)
        shape_turn = turn @ rotation(m.shape_qw[i], m.shape_qx[i], m.shape_qy[i], m.shape_qz[i])
        origin = np.asarray(p) + turn @ (m.shape_px[i], m.shape_py[i], m.shape_pz[i])
        for face in shape_faces(m, i, vertices):
            faces.append(face @ shape_turn.T + origin)
            colors.append((m.red[i], m.green[i], m.blue[i]))
    return faces, np.array(colors)


def draw(faces, colors, file):
    """Lit faces over a ground with their shadows."""
    normals = np.array([np.cross(face[2] - face[0], face[-1] - face[1]) for face in faces])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    lit = 0.45 + 0.55 * np.clip(normals @ LIGHT, 0, 1)
    shadows = [face - np.outer(face[:, 2] / LIGHT[2], LIGHT) for face in faces]
    everything = np.concatenate(faces)
    figure = pyplot.figure(figsize=(10, 6.2), dpi=110)
    axes = figure.add_axes([-0.25, -0.35, 1.5, 1.7], projection="3d", computed_zorder=False)
    axes.add_collection3d(Poly3DCollection(shadows, facecolors="#d5d8dc", zorder=1))
    axes.add_collection3d(Poly3DCollection(faces, facecolors=colors * lit[:, None], edgecolors=(0, 0, 0, 0.15),
                                           linewidths=0.2, zorder=2))
    low, high = everything.min(axis=0), everything.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(0, high[2]))
    axes.set_box_aspect(np.array([high[0] - low[0], high[1] - low[1], high[2]]))
    axes.view_init(elev=22, azim=-62)
    axes.set_axis_off()
    figure.savefig(file)


def main():
    demo, steps, file = (sys.argv[1:] + ["pile", "480", SCENES / "pile.png"][len(sys.argv) - 1:])[:3]
    with tempfile.TemporaryDirectory() as folder:
        with Server(pathlib.Path(folder) / "log", "--demo", demo) as server:
            wire = Wire()
            wire.next("HEARTBEAT", 10.0)
            for verb, count in (("PAUSE", 0), ("RESET", 0), ("PAUSE", 0), ("STEP", int(steps))):
                answer = wire.ask(wire.control(wire.verb(verb), count=count), 30.0)
                assert answer.status == APPLIED, answer.detail
            wire.next("HEARTBEAT", 60.0, lambda m: m.paused and m.step >= int(steps))
            wire.listen(2.5)  # every body's state and description comes round
            server.stop()
    draw(*collect_faces(wire), file)


if __name__ == "__main__":
    main()
