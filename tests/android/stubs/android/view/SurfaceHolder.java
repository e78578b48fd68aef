package android.view;

public interface SurfaceHolder {
    Surface getSurface();

    void addCallback(Callback callback);

    interface Callback {
        void surfaceCreated(SurfaceHolder holder);

        void surfaceChanged(SurfaceHolder holder, int format, int width, int height);

        void surfaceDestroyed(SurfaceHolder holder);
    }
}
