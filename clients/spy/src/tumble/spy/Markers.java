// What the view draws over the bodies: touching points and force arrows, as <WORLD>_CONTACTS and <WORLD>_PUSHES told last.
package tumble.spy;

import java.util.ArrayList;
import java.util.List;
import tumble.contacts_t;
import tumble.pushes_t;

final class Markers {
    /** A line from a point of the world, of which only direction and relative length count. */
    static final class Arrow {
        final double[] from, along;

        Arrow(double[] from, double[] along) {
            this.from = from;
            this.along = along;
        }

        double length() { return Math.sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]); }
    }

    private List<Arrow> contacts = new ArrayList<>(), pushes = new ArrayList<>();
    private long contactsTime;

    synchronized List<Arrow> contacts() { return new ArrayList<>(contacts); }

    synchronized List<Arrow> pushes() { return new ArrayList<>(pushes); }

    synchronized void merge(contacts_t m) {
        if (m.utime < contactsTime) return;
        if (m.utime > contactsTime) contacts = new ArrayList<>();
        contactsTime = m.utime;
        for (int i = 0; i < m.n; ++i) {
            contacts.add(new Arrow(new double[] {m.px[i], m.py[i], m.pz[i]}, new double[] {m.jx[i], m.jy[i], m.jz[i]}));
        }
    }

    synchronized void merge(pushes_t m) {
        pushes = new ArrayList<>();
        for (int i = 0; i < m.n; ++i) {
            pushes.add(new Arrow(new double[] {m.px[i], m.py[i], m.pz[i]}, new double[] {m.fx[i], m.fy[i], m.fz[i]}));
        }
    }
}
