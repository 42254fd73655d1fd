// The view of the world in lcm-spy: double-click <WORLD>_STATE or <WORLD>_PACKED, or choose it from the channel's menu. lcm-spy finds
// this class by its interface. Contacts and pushes are asked for while a window is open.
package tumble.spy;

import java.awt.event.ActionEvent;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.io.IOException;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.JSplitPane;
import javax.swing.Timer;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import tumble.catalog_t;
import tumble.contacts_t;
import tumble.control_t;
import tumble.packed_t;
import tumble.pushes_t;
import tumble.state_t;

public final class WorldPlugin implements SpyPlugin {
    private static final int REDRAW_MS = 40;
    private static final int ASK_MS = 2000; // the network may lose it, and the server may start anew

    private final String world;
    private final Picture picture = new Picture();
    private final Markers markers = new Markers();
    private final long client = System.nanoTime() | 1;
    private long sequence;

    /** For lcm-spy, which asks what it can draw. */
    public WorldPlugin() { this(""); }

    private WorldPlugin(String world) { this.world = world; }

    @Override public boolean canHandle(long fingerprint) {
        return fingerprint == state_t.LCM_FINGERPRINT || fingerprint == packed_t.LCM_FINGERPRINT;
    }

    @Override public Action getAction(JDesktopPane desktop, ChannelData channel) {
        return new AbstractAction("Draw the world") {
            @Override public void actionPerformed(ActionEvent event) {
                new WorldPlugin(channel.name.replaceFirst("_(STATE|PACKED)$", "")).open();
            }
        };
    }

    private void open() {
        String channels = world + "_(STATE|PACKED|CATALOG|CONTACTS|PUSHES)";
        LCMSubscriber subscriber = (lcm, channel, input) -> receive(channel, input);
        LCM.getSingleton().subscribe(channels, subscriber);
        WorldView above = new WorldView(picture, markers, "from above", Math.PI / 2);
        WorldView aside = new WorldView(picture, markers, "from the side", 0.15);
        JFrame frame = new JFrame(world);
        JSplitPane panes = new JSplitPane(JSplitPane.HORIZONTAL_SPLIT, above, aside);
        panes.setResizeWeight(0.5);
        panes.setDividerLocation(550);
        frame.add(panes);
        frame.setSize(1100, 620);
        Timer redraw = new Timer(REDRAW_MS, tick -> panes.repaint());
        Timer ask = new Timer(ASK_MS, tick -> ask(control_t.VERB_CONTACTS_ON, control_t.VERB_PUSHES_ON));
        ask.setInitialDelay(0);
        frame.setDefaultCloseOperation(JFrame.DISPOSE_ON_CLOSE);
        frame.addWindowListener(new WindowAdapter() {
            @Override public void windowClosed(WindowEvent event) {
                redraw.stop();
                ask.stop();
                ask(control_t.VERB_CONTACTS_OFF, control_t.VERB_PUSHES_OFF);
                LCM.getSingleton().unsubscribe(channels, subscriber);
            }
        });
        frame.setVisible(true);
        redraw.start();
        ask.start();
    }

    private void ask(byte... verbs) {
        for (byte verb : verbs) {
            control_t command = new control_t();
            command.client = client;
            command.sequence = ++sequence;
            command.verb = verb;
            command.name = "";
            command.orientation[0] = 1;
            LCM.getSingleton().publish(world + "_CONTROL", command);
        }
    }

    private void receive(String channel, LCMDataInputStream input) {
        try {
            if (channel.endsWith("_STATE")) {
                picture.merge(new state_t(input));
            } else if (channel.endsWith("_PACKED")) {
                picture.merge(new packed_t(input));
            } else if (channel.endsWith("_CATALOG")) {
                picture.merge(new catalog_t(input));
            } else if (channel.endsWith("_CONTACTS")) {
                markers.merge(new contacts_t(input));
            } else {
                markers.merge(new pushes_t(input));
            }
        } catch (IOException | RuntimeException damaged) {
            // A message of another type on this channel; lcm-spy itself counts it as undecodable.
        }
    }
}
