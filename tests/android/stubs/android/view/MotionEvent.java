package android.view;

/** A stand-in: an action, and the places of the fingers as x, y, x, y. */
public final class MotionEvent {
    public static final int ACTION_DOWN = 0, ACTION_UP = 1, ACTION_MOVE = 2;
    private final int action;
    private final float[] places;

    public MotionEvent(int action, float... places) {
        this.action = action;
        this.places = places;
    }

    public final int getActionMasked() {
        return action;
    }

    public final int getPointerCount() {
        return places.length / 2;
    }

    public final float getX(int finger) {
        return places[2 * finger];
    }

    public final float getY(int finger) {
        return places[2 * finger + 1];
    }
}
