package android.content.res;

import java.io.FileInputStream;
import java.io.FileNotFoundException;
import java.io.IOException;
import java.io.InputStream;

/** A stand-in: an asset lies 4 bytes behind the beginning of a file, as zipalign puts it; NAME.z is compressed. */
public class AssetManager {
    private static final int BEFORE = 4;
    private final String folder;

    public AssetManager(String folder) {
        this.folder = folder;
    }

    public AssetFileDescriptor openFd(String name) throws IOException {
        if (name.endsWith(".z"))
            throw new FileNotFoundException("it is probably compressed");
        final FileInputStream file = new FileInputStream(folder + "/" + name);
        return new AssetFileDescriptor(file, BEFORE, file.getChannel().size() - BEFORE);
    }

    public InputStream open(String name) throws IOException {
        final InputStream file = new FileInputStream(folder + "/" + name);
        return file.skip(BEFORE) == BEFORE ? file : null;
    }
}
