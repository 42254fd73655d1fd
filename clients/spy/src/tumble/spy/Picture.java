// What the view draws: bodies merged from <WORLD>_STATE or <WORLD>_PACKED, and <WORLD>_CATALOG. Only the newest news of a body counts;
// a body is gone when a catalogue of a newer epoch no longer lists it; a new session starts from nothing.
package tumble.spy;

import java.util.ArrayList;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import tumble.catalog_t;
import tumble.packed_t;
import tumble.state_t;

final class Picture {
    static final class Shape {
        byte type;
        double[] size, position, orientation;
        float[] color;
    }

    static final class Body {
        int generation;
        long epoch, step = -1;
        String name = "";
        byte flags, typeFlag;
        boolean described;
        double[] position, orientation;
        final Map<Integer, Shape> shapes = new HashMap<>();
    }

    private final Map<Integer, Body> bodies = new HashMap<>();
    private long session, epoch = -1, step = -1;
    private double time;

    synchronized List<Body> placedBodies() {
        List<Body> placed = new ArrayList<>();
        for (Body body : bodies.values()) if (body.step >= 0) placed.add(body);
        return placed;
    }

    synchronized String summary() {
        return String.format("step %d   %.2f s   %d bodies", step, time, bodies.size());
    }

    synchronized void merge(state_t m) {
        adoptSession(m.session);
        place(m, m.catalog_epoch >= epoch);
    }

    /** Whoever the catalogue has not told of yet comes with a refresh. */
    synchronized void merge(packed_t m) {
        adoptSession(m.session);
        state_t state = PackedRecords.unpack(m);
        for (int i = 0; i < m.n; ++i) {
            Body body = bodies.get(state.id[i]);
            boolean known = body != null && body.described
                && body.generation % PackedRecords.GENERATIONS == state.generation[i];
            state.generation[i] = known ? body.generation : -1;
            if (known) state.flags[i] |= body.typeFlag;
        }
        place(state, false);
    }

    private void place(state_t m, boolean mayCreate) {
        epoch = Math.max(epoch, m.catalog_epoch);
        if (m.step >= step) {
            step = m.step;
            time = m.time;
        }
        for (int i = 0; i < m.n; ++i) {
            Body body = bodyFor(m.id[i], m.generation[i], mayCreate);
            if (body == null || m.step < body.step) continue;
            body.epoch = Math.max(body.epoch, m.catalog_epoch);
            body.step = m.step;
            body.flags = m.flags[i];
            body.position = new double[] {m.px[i], m.py[i], m.pz[i]};
            body.orientation = new double[] {m.qw[i], m.qx[i], m.qy[i], m.qz[i]};
        }
    }

    synchronized void merge(catalog_t m) {
        adoptSession(m.session);
        if (m.epoch < epoch) return;
        epoch = m.epoch;
        Map<Integer, String> listed = new HashMap<>();
        for (int i = 0; i < m.n; ++i) listed.put(m.id[i], m.name[i]);
        bodies.entrySet().removeIf(entry -> entry.getKey() >= m.first_id && entry.getKey() < m.end_id
            && !listed.containsKey(entry.getKey()) && entry.getValue().epoch < m.epoch);
        for (int i = 0; i < m.n; ++i) {
            Body body = bodyFor(m.id[i], m.generation[i], true);
            if (body == null) continue;
            body.name = m.name[i];
            body.epoch = m.epoch;
            body.described = true;
            body.typeFlag = m.type[i] == catalog_t.TYPE_STATIC ? state_t.FLAG_STATIC
                : m.type[i] == catalog_t.TYPE_KINEMATIC ? state_t.FLAG_KINEMATIC : 0;
        }
        for (int i = 0; i < m.num_shapes; ++i) mergeShape(m, i);
    }

    private void mergeShape(catalog_t m, int i) {
        Body body = bodies.get(m.shape_body[i]);
        if (body == null) return;
        Shape shape = new Shape();
        shape.type = m.shape_type[i];
        shape.size = new double[] {m.size_x[i], m.size_y[i], m.size_z[i]};
        shape.position = new double[] {m.shape_px[i], m.shape_py[i], m.shape_pz[i]};
        shape.orientation = new double[] {m.shape_qw[i], m.shape_qx[i], m.shape_qy[i], m.shape_qz[i]};
        shape.color = new float[] {m.red[i], m.green[i], m.blue[i], m.alpha[i]};
        body.shapes.put(m.shape_number[i], shape);
    }

    private void adoptSession(long other) {
        if (other == session) return;
        bodies.clear();
        session = other;
        epoch = step = -1;
    }

    private Body bodyFor(int id, int generation, boolean mayCreate) {
        Body body = bodies.get(id);
        if (body != null && body.generation == generation) return body;
        if (!mayCreate || (body != null && body.generation > generation)) return null;
        body = new Body();
        body.generation = generation;
        bodies.put(id, body);
        return body;
    }
}
