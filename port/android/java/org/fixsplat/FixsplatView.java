package org.fixsplat;

import android.content.ComponentCallbacks2;
import android.content.Context;
import android.content.res.Configuration;
import android.util.AttributeSet;
import android.view.MotionEvent;
import android.view.Surface;
import android.view.SurfaceHolder;
import android.view.SurfaceView;

/**
 * A view that shows a scene. One finger turns the scene; two fingers move it and bring it nearer. The view lives until
 * {@link #close}, which an activity calls in onDestroy.
 */
public class FixsplatView extends SurfaceView implements SurfaceHolder.Callback, ComponentCallbacks2, AutoCloseable {
    private Fixsplat scene;
    private Surface surface;
    private double lastX, lastY, lastSpread;
    private int lastFingers;

    public FixsplatView(Context context) {
        this(context, null);
    }

    public FixsplatView(Context context, AttributeSet attributes) {
        super(context, attributes);
        getHolder().addCallback(this);
    }

    /** Begins, with a listener or null. */
    public Fixsplat start(Fixsplat.Listener listener) throws FixsplatException {
        if (scene != null)
            throw new IllegalStateException("this view was started before");
        scene = new Fixsplat(listener);
        scene.setSurface(surface);
        getContext().getApplicationContext().registerComponentCallbacks(this);
        return scene;
    }

    @Override public void close() {
        if (scene != null) {
            getContext().getApplicationContext().unregisterComponentCallbacks(this);
            scene.close();
        }
        scene = null;
    }

    /* ---- The surface --------------------------------------------------------------------------------------------- */

    @Override public void surfaceCreated(SurfaceHolder holder) {
    }

    @Override public void surfaceChanged(SurfaceHolder holder, int format, int width, int height) {
        setSurface(holder.getSurface());
    }

    @Override public void surfaceDestroyed(SurfaceHolder holder) {
        setSurface(null);
    }

    private void setSurface(Surface now) {
        surface = now;
        if (scene != null)
            scene.setSurface(now);
    }

    /* ---- Memory -------------------------------------------------------------------------------------------------- */

    @Override public void onTrimMemory(int level) {
        if (scene != null && level >= TRIM_MEMORY_RUNNING_LOW && level != TRIM_MEMORY_UI_HIDDEN)
            scene.trim();
    }

    @Override public void onLowMemory() {
        onTrimMemory(TRIM_MEMORY_RUNNING_LOW);
    }

    @Override public void onConfigurationChanged(Configuration configuration) {
    }

    /* ---- Touches ------------------------------------------------------------------------------------------------- */

    @Override public boolean onTouchEvent(MotionEvent event) {
        final int fingers = Math.min(event.getPointerCount(), 2);
        final double x = (event.getX(0) + event.getX(fingers - 1)) / 2;
        final double y = (event.getY(0) + event.getY(fingers - 1)) / 2;
        final double spread = Math.hypot(event.getX(0) - event.getX(fingers - 1),
                                         event.getY(0) - event.getY(fingers - 1));
        final Camera camera = scene == null ? null : scene.getCamera();
        if (event.getActionMasked() == MotionEvent.ACTION_MOVE && fingers == lastFingers && camera != null)
            scene.setCamera(moved(camera, fingers, x, y, spread));
        lastFingers = event.getActionMasked() == MotionEvent.ACTION_UP ? 0 : fingers;
        lastX = x;
        lastY = y;
        lastSpread = spread;
        return true;
    }

    /** A finger that crosses the shorter side turns the scene by half a turn. */
    private Camera moved(Camera camera, int fingers, double x, double y, double spread) {
        final double side = Math.max(1, Math.min(getWidth(), getHeight()));
        final double right = (x - lastX) / side, down = (y - lastY) / side;
        if (fingers == 1)
            return camera.orbit(right * Math.PI, down * Math.PI);
        return camera.pan(right, down).zoom(lastSpread > 1 && spread > 1 ? spread / lastSpread : 1);
    }
}
