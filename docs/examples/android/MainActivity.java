package org.fixsplat.sample;

import android.app.Activity;
import android.os.Bundle;
import android.util.Log;
import org.fixsplat.Fixsplat;
import org.fixsplat.FixsplatException;
import org.fixsplat.FixsplatView;

/** Shows the asset scene.fxs. Touches turn, move and enlarge it. */
public class MainActivity extends Activity {
    private FixsplatView view;

    @Override protected void onCreate(Bundle saved) {
        super.onCreate(saved);
        view = new FixsplatView(this);
        setContentView(view);
        try {
            view.start(new Fixsplat.Listener() {
                @Override public void onFault(FixsplatException fault) {
                    Log.w("sample", fault.getMessage());
                }
            }).openAsset(getAssets(), "scene.fxs");
        } catch (FixsplatException fault) {
            Log.w("sample", fault.getMessage());
        }
    }

    @Override protected void onDestroy() {
        view.close();
        super.onDestroy();
    }
}
