// Draws the bodies as wire frames to scale, hulls as points; contacts in red, with their impulses; pushes as blue
// arrows. Drag turns, wheel zooms, right drag moves. World frame: z up.
package tumble.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import java.awt.event.MouseAdapter;
import java.awt.event.MouseEvent;
import java.awt.event.MouseWheelEvent;
import java.util.List;
import javax.swing.JPanel;
import javax.swing.SwingUtilities;
import tumble.catalog_t;
import tumble.state_t;

final class WorldView extends JPanel {
    private static final int RING = 24; // corners of a circle
    private static final int MAX_NAMES = 40; // more would cover each other
    private static final int ARROW = 60; // pixels of the longest arrow of a kind
    private static final Color CONTACT = new Color(0xc0392b), PUSH = new Color(0x2456a8);
    private final Picture picture;
    private final Markers markers;
    private final String title;
    private double azimuth = -Math.PI / 2, elevation, pixelsPerMetre, centreX, centreY;
    private int lastX, lastY;
    private int fitted; // bodies that the view was fitted to
    private boolean chosen; // by the user, who keeps the view

    WorldView(Picture picture, Markers markers, String title, double elevation) {
        this.picture = picture;
        this.markers = markers;
        this.title = title;
        this.elevation = elevation;
        setBackground(new Color(0xf7f7f4));
        MouseAdapter mouse = new MouseAdapter() {
            @Override public void mousePressed(MouseEvent event) {
                lastX = event.getX();
                lastY = event.getY();
            }
            @Override public void mouseDragged(MouseEvent event) { drag(event); }
            @Override public void mouseWheelMoved(MouseWheelEvent event) {
                chosen = true;
                pixelsPerMetre *= Math.pow(0.9, event.getPreciseWheelRotation());
                repaint();
            }
        };
        addMouseListener(mouse);
        addMouseMotionListener(mouse);
        addMouseWheelListener(mouse);
    }

    private void drag(MouseEvent event) {
        chosen = true;
        int dx = event.getX() - lastX, dy = event.getY() - lastY;
        lastX = event.getX();
        lastY = event.getY();
        if (SwingUtilities.isRightMouseButton(event)) {
            centreX -= dx / pixelsPerMetre;
            centreY += dy / pixelsPerMetre;
        } else {
            azimuth -= 0.01 * dx;
            elevation = Math.max(-1.57, Math.min(1.57, elevation + 0.01 * dy));
        }
        repaint();
    }

    /** World point to right and up on the screen [m]. */
    private double[] project(double[] p) {
        double ca = Math.cos(azimuth), sa = Math.sin(azimuth), ce = Math.cos(elevation), se = Math.sin(elevation);
        return new double[] {-sa * p[0] + ca * p[1], -se * (ca * p[0] + sa * p[1]) + ce * p[2]};
    }

    /** Chooses scale and centre so that all bodies that can move are seen. */
    private void fit(List<Picture.Body> bodies) {
        double[] low = {1e9, 1e9}, high = {-1e9, -1e9};
        for (Picture.Body body : bodies) {
            if ((body.flags & state_t.FLAG_STATIC) != 0) continue;
            double[] q = project(body.position);
            for (int k = 0; k < 2; ++k) {
                low[k] = Math.min(low[k], q[k]);
                high[k] = Math.max(high[k], q[k]);
            }
        }
        if (low[0] > high[0]) return;
        fitted = bodies.size();
        centreX = (low[0] + high[0]) / 2;
        centreY = (low[1] + high[1]) / 2;
        double margin = 2.0; // [m]
        pixelsPerMetre = Math.min(getWidth() / (high[0] - low[0] + margin), getHeight() / (high[1] - low[1] + margin));
    }

    @Override protected void paintComponent(Graphics graphics) {
        super.paintComponent(graphics);
        Graphics2D g = (Graphics2D) graphics;
        List<Picture.Body> bodies = picture.placedBodies();
        if (!chosen && bodies.size() != fitted) fit(bodies); // they come in over the first second
        if (pixelsPerMetre == 0) return;
        g.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
        drawGrid(g);
        g.setStroke(new BasicStroke(1.3f));
        bodies.sort((a, b) -> Double.compare(depth(a.position), depth(b.position)));
        for (Picture.Body body : bodies) {
            boolean still = (body.flags & (state_t.FLAG_RESTING | state_t.FLAG_STATIC)) != 0;
            for (Picture.Shape shape : body.shapes.values()) {
                Color color = new Color(shape.color[0], shape.color[1], shape.color[2]);
                g.setColor(still ? color.darker() : color);
                drawShape(g, body, shape);
            }
        }
        drawArrows(g, markers.contacts(), CONTACT);
        g.setStroke(new BasicStroke(2.5f));
        drawArrows(g, markers.pushes(), PUSH);
        g.setColor(Color.DARK_GRAY);
        if (bodies.size() <= MAX_NAMES) {
            for (Picture.Body body : bodies) g.drawString(body.name, screenX(body.position) + 4, screenY(body.position) - 4);
        }
        g.drawString(title + "     " + picture.summary(), 8, 16);
        g.drawString("drag: turn   right drag: move   wheel: zoom", 8, getHeight() - 8);
    }

    /** A dot and a line for each; the longest is ARROW pixels. */
    private void drawArrows(Graphics2D g, List<Markers.Arrow> arrows, Color color) {
        double longest = 0;
        for (Markers.Arrow arrow : arrows) longest = Math.max(longest, arrow.length());
        g.setColor(color);
        for (Markers.Arrow arrow : arrows) {
            int x = screenX(arrow.from), y = screenY(arrow.from);
            g.fillOval(x - 2, y - 2, 5, 5);
            if (longest == 0) continue;
            double[] along = project(arrow.along);
            g.drawLine(x, y, (int) Math.round(x + ARROW * along[0] / longest), (int) Math.round(y - ARROW * along[1] / longest));
        }
    }

    private double depth(double[] p) {
        double ce = Math.cos(elevation);
        return ce * Math.cos(azimuth) * p[0] + ce * Math.sin(azimuth) * p[1] + Math.sin(elevation) * p[2];
    }

    /** The plane z = 0, a line every metre, or every ten or hundred where they would be too close. */
    private void drawGrid(Graphics2D g) {
        double gap = 1;
        while (gap * pixelsPerMetre < 12) gap *= 10;
        g.setStroke(new BasicStroke(0.5f));
        for (int i = -10; i <= 10; ++i) {
            g.setColor(i == 0 ? Color.GRAY : Color.LIGHT_GRAY);
            line(g, new double[] {i * gap, -10 * gap, 0}, new double[] {i * gap, 10 * gap, 0});
            line(g, new double[] {-10 * gap, i * gap, 0}, new double[] {10 * gap, i * gap, 0});
        }
    }

    private void drawShape(Graphics2D g, Picture.Body body, Picture.Shape shape) {
        double[] s = shape.size;
        switch (shape.type) {
            case catalog_t.SHAPE_SPHERE -> {
                for (int axis = 0; axis < 3; ++axis) ring(g, body, shape, s[0], s[0], axis, 0);
            }
            case catalog_t.SHAPE_CAPSULE -> {
                for (int axis = 0; axis < 3; ++axis) {
                    ring(g, body, shape, s[0], s[0], axis, -s[1] / 2);
                    ring(g, body, shape, s[0], s[0], axis, s[1] / 2);
                }
                sides(g, body, shape, 1);
            }
            case catalog_t.SHAPE_CYLINDER -> {
                for (int side = -1; side <= 1; side += 2) ring(g, body, shape, s[0], s[0], 2, side * s[1] / 2);
                sides(g, body, shape, 1);
            }
            case catalog_t.SHAPE_CONE -> {
                ring(g, body, shape, s[0], s[0], 2, -s[1] / 2);
                sides(g, body, shape, 0);
            }
            case catalog_t.SHAPE_ELLIPSOID -> {
                for (int axis = 0; axis < 3; ++axis) {
                    ring(g, body, shape, s[axis == 0 ? 1 : 0], s[axis == 2 ? 1 : 2], axis, 0);
                }
            }
            case catalog_t.SHAPE_BOX -> box(g, body, shape);
            case catalog_t.SHAPE_HULL, catalog_t.SHAPE_TRIANGLE_MESH, catalog_t.SHAPE_HEIGHT_FIELD -> {
                int x = screenX(body.position), y = screenY(body.position);
                g.drawOval(x - 3, y - 3, 6, 6);
            }
            default -> { } // the grid shows the ground
        }
    }

    private void box(Graphics2D g, Picture.Body body, Picture.Shape shape) {
        double[][] corners = new double[8][];
        for (int c = 0; c < 8; ++c) {
            corners[c] = place(body, shape, shape.size[0] * ((c & 1) - 0.5), shape.size[1] * ((c >> 1 & 1) - 0.5),
                shape.size[2] * ((c >> 2 & 1) - 0.5));
        }
        for (int c = 0; c < 8; ++c) {
            for (int bit = 1; bit < 8; bit <<= 1) if ((c & bit) == 0) line(g, corners[c], corners[c | bit]);
        }
    }

    /** Four lines from the radius at the bottom of a round shape to `taper` times the radius at its top. */
    private void sides(Graphics2D g, Picture.Body body, Picture.Shape shape, double taper) {
        double r = shape.size[0], z = shape.size[1] / 2;
        for (double[] side : new double[][] {{r, 0}, {-r, 0}, {0, r}, {0, -r}}) {
            line(g, place(body, shape, side[0], side[1], -z), place(body, shape, taper * side[0], taper * side[1], z));
        }
    }

    /** An ellipse around `axis` with half axes u and v along the two others, shifted along the shape's z. */
    private void ring(Graphics2D g, Picture.Body body, Picture.Shape shape, double u, double v, int axis, double z) {
        double[] last = null;
        for (int i = 0; i <= RING; ++i) {
            double a = u * Math.cos(2 * Math.PI * i / RING), b = v * Math.sin(2 * Math.PI * i / RING);
            double[] next = switch (axis) {
                case 0 -> place(body, shape, 0, a, b + z);
                case 1 -> place(body, shape, a, 0, b + z);
                default -> place(body, shape, a, b, z);
            };
            if (last != null) line(g, last, next);
            last = next;
        }
    }

    /** A point of the shape in the world: p_WB + q_WB (p_BS + q_BS p). */
    private static double[] place(Picture.Body body, Picture.Shape shape, double x, double y, double z) {
        double[] inBody = add(shape.position, rotate(shape.orientation, new double[] {x, y, z}));
        return add(body.position, rotate(body.orientation, inBody));
    }

    private static double[] add(double[] a, double[] b) {
        return new double[] {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    }

    private static double[] cross(double[] a, double x, double y, double z) {
        return new double[] {a[2] * z - a[3] * y, a[3] * x - a[1] * z, a[1] * y - a[2] * x};
    }

    /** v + 2 w (u x v) + 2 u x (u x v) with q = (w, u). */
    private static double[] rotate(double[] q, double[] v) {
        double[] t = cross(q, v[0], v[1], v[2]);
        double[] tt = cross(q, t[0], t[1], t[2]);
        return new double[] {v[0] + 2 * (q[0] * t[0] + tt[0]), v[1] + 2 * (q[0] * t[1] + tt[1]), v[2] + 2 * (q[0] * t[2] + tt[2])};
    }

    private int screenX(double[] p) { return (int) Math.round(getWidth() / 2.0 + pixelsPerMetre * (project(p)[0] - centreX)); }
    private int screenY(double[] p) { return (int) Math.round(getHeight() / 2.0 - pixelsPerMetre * (project(p)[1] - centreY)); }

    private void line(Graphics2D g, double[] a, double[] b) {
        g.drawLine(screenX(a), screenY(a), screenX(b), screenY(b));
    }
}
