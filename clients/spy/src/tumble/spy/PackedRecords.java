// The bodies of a packed_t, 25 bytes each, as rows of a state_t: see "Packed" in protocol/README.md. Generations keep
// their lowest bits only, and the flags of a body's type are missing: the catalogue knows both.
package tumble.spy;

import tumble.packed_t;
import tumble.state_t;

final class PackedRecords {
    static final int GENERATIONS = 16;
    private static final int RECORD = 25;
    private static final byte[] KEPT_FLAGS = {state_t.FLAG_RESTING, state_t.FLAG_CONTAINED, state_t.FLAG_WATCHED};
    private static final double TURN_LIMIT = Math.sqrt(0.5);

    private final byte[] records;
    private int bit;

    private PackedRecords(byte[] records) { this.records = records; }

    /** Positions and orientations of the message; velocities are not drawn and stay null. */
    static state_t unpack(packed_t m) {
        if (m.size != RECORD * m.n) throw new IllegalArgumentException("size of the records");
        state_t state = new state_t();
        state.session = m.session;
        state.step = m.step;
        state.time = m.time;
        state.catalog_epoch = m.catalog_epoch;
        state.n = m.n;
        state.id = new int[m.n];
        state.generation = new int[m.n];
        state.flags = new byte[m.n];
        double[][] position = new double[3][m.n], orientation = new double[4][m.n];
        PackedRecords bits = new PackedRecords(m.records);
        for (int i = 0; i < m.n; ++i) {
            bits.bit = 8 * RECORD * i;
            state.id[i] = m.first_id + bits.next(14);
            for (byte flag : KEPT_FLAGS) state.flags[i] |= bits.next(1) != 0 ? flag : 0;
            state.generation[i] = bits.next(4);
            for (int k = 0; k < 3; ++k) position[k][i] = m.origin[k] + bits.next(20) / (double) 0xfffff * m.edge;
            bits.readOrientation(orientation, i);
        }
        state.px = position[0];
        state.py = position[1];
        state.pz = position[2];
        state.qw = orientation[0];
        state.qx = orientation[1];
        state.qy = orientation[2];
        state.qz = orientation[3];
        return state;
    }

    private void readOrientation(double[][] q, int i) {
        int largest = next(2);
        double rest = 1;
        for (int k = 0; k < 4; ++k) {
            if (k == largest) continue;
            q[k][i] = (next(13) / (double) 0x1fff * 2 - 1) * TURN_LIMIT;
            rest -= q[k][i] * q[k][i];
        }
        q[largest][i] = Math.sqrt(Math.max(rest, 0));
    }

    private int next(int count) {
        int value = 0;
        for (int end = bit + count; bit < end; ++bit) value = value << 1 | (records[bit / 8] >> (7 - bit % 8) & 1);
        return value;
    }
}
