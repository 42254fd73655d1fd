// The view of the world in lcm-spy: double-click <WORLD>_STATE, or choose it from the channel's menu. lcm-spy finds
// this class by its interface.
package tumble.spy;

import java.awt.event.ActionEvent;
import java.io.IOException;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.Timer;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import tumble.catalog_t;
import tumble.state_t;

public final class WorldPlugin implements SpyPlugin {
    private static final int REDRAW_MS = 40;

    @Override public boolean canHandle(long fingerprint) { return fingerprint == state_t.LCM_FINGERPRINT; }

    @Override public Action getAction(JDesktopPane desktop, ChannelData channel) {
        return new AbstractAction("Draw the world") {
            @Override public void actionPerformed(ActionEvent event) { open(channel.name.replaceFirst("_STATE$", "")); }
        };
    }

    private static void open(String world) {
        Picture picture = new Picture();
        LCMSubscriber subscriber = (lcm, channel, input) -> receive(picture, channel, input);
        String channels = world + "_(STATE|CATALOG)";
        LCM.getSingleton().subscribe(channels, subscriber);
        WorldView view = new WorldView(picture);
        JFrame frame = new JFrame(world);
        frame.add(view);
        frame.setSize(900, 650);
        Timer timer = new Timer(REDRAW_MS, tick -> view.repaint());
        frame.setDefaultCloseOperation(JFrame.DISPOSE_ON_CLOSE);
        frame.addWindowListener(new java.awt.event.WindowAdapter() {
            @Override public void windowClosed(java.awt.event.WindowEvent event) {
                timer.stop();
                LCM.getSingleton().unsubscribe(channels, subscriber);
            }
        });
        frame.setVisible(true);
        timer.start();
    }

    private static void receive(Picture picture, String channel, LCMDataInputStream input) {
        try {
            if (channel.endsWith("_STATE")) {
                picture.merge(new state_t(input));
            } else {
                picture.merge(new catalog_t(input));
            }
        } catch (IOException | RuntimeException damaged) {
            // A message of another type on this channel; lcm-spy itself counts it as undecodable.
        }
    }
}
