/* Splits the command line into arguments. Expands wildcards such as *.ply, because cmd and PowerShell do not. */
#include "win32.h"

#include <shellapi.h>
#include <stdlib.h>
#include <string.h>
#include <wctype.h>

/* Placeholders for quoted * and ?, which are not wildcards. Both placeholders are noncharacters of Unicode. */
enum { QUOTED_STAR = 0xfdd0, QUOTED_QUESTION = 0xfdd1 };

/* Copies a command line and replaces quoted * and ? by placeholders. closes: 1 if \" ends a quoted argument, as in
   "C:\a folder\". Returns 1 if a quote stays open. */
static int mark_quoted(wchar_t *to, const wchar_t *line, int closes)
{
    int is_quoted = 0;
    size_t slashes = 0;
    for (; *line; line++) {
        if (*line == L'"' && slashes % 2 && is_quoted && closes) {
            *to++ = L'\\';
            slashes++;
        }
        is_quoted ^= *line == L'"' && slashes % 2 == 0;
        slashes = *line == L'\\' ? slashes + 1 : 0;
        *to++ = is_quoted && *line == L'*' ? QUOTED_STAR : is_quoted && *line == L'?' ? QUOTED_QUESTION : *line;
    }
    *to = 0;
    return is_quoted;
}

typedef struct word_list {
    wchar_t **words;
    size_t count, room;
    int incomplete;
} word_list;

static void add_word(word_list *list, wchar_t *word)
{
    if (word && list->count == list->room) {
        const size_t room = 2 * list->room + 16;
        wchar_t **larger = realloc(list->words, room * sizeof *larger);
        list->words = larger ? larger : list->words;
        list->room = larger ? room : list->room;
    }
    if (word && list->count < list->room)
        list->words[list->count++] = word;
    else {
        list->incomplete = 1;
        free(word);
    }
}

static void free_words(word_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->words[i]);
    free(list->words);
}

/* Returns 1 if a file name matches a pattern: * stands for any characters, ? for one. Case is ignored. */
static int matches(const wchar_t *name, const wchar_t *pattern)
{
    const wchar_t *star = NULL, *from = NULL;
    while (*name)
        if (*pattern == L'*') {
            star = ++pattern;
            from = name;
        } else if (*pattern && (*pattern == L'?' || towlower(*pattern) == towlower(*name))) {
            pattern++;
            name++;
        } else if (star) {
            pattern = star;
            name = ++from;
        } else
            return 0;
    while (*pattern == L'*')
        pattern++;
    return !*pattern;
}

static const wchar_t *name_of(const wchar_t *path)
{
    const wchar_t *name = path;
    for (; *path; path++)
        name = *path == L'\\' || *path == L'/' || *path == L':' ? path + 1 : name;
    return name;
}

typedef struct search {
    const wchar_t *path;
    word_list found;
} search;

/* Adds a file name that matches a wildcard to the arguments. Puts ./ before a name that begins with -, so that the name
   is not read as an option. */
static void take_name(void *search_, const char *text)
{
    search *s = search_;
    const wchar_t *pattern = name_of(s->path);
    wchar_t *name = win32_wide(text);
    if (name && wcscmp(name, L".") && wcscmp(name, L"..") && matches(name, pattern)) {
        const int is_bare = pattern == s->path && *name == L'-';
        const wchar_t *before = is_bare ? L"./" : s->path;
        const size_t folder = is_bare ? wcslen(before) : (size_t)(pattern - s->path);
        wchar_t *whole = malloc((folder + wcslen(name) + 1) * sizeof *whole);
        if (whole) {
            memcpy(whole, before, folder * sizeof *whole);
            wcscpy(whole + folder, name);
        }
        add_word(&s->found, whole);
    }
    free(name);
}

static int compare(const void *a, const void *b)
{
    const wchar_t *first = *(wchar_t *const *)a, *second = *(wchar_t *const *)b;
    const int order = _wcsicmp(first, second);
    return order ? order : wcscmp(first, second);
}

static void find(search *s)
{
    const wchar_t *pattern = name_of(s->path);
    wchar_t *wide = _wcsdup(s->path);
    if (wide)
        wide[pattern - s->path] = 0;
    char *folder = wide ? win32_narrow(*wide ? wide : L".") : NULL;
    if (folder && (!*wide || wide[pattern - s->path - 1] != L':'))
        fxs_folder_each(folder, take_name, s);
    s->found.incomplete |= !folder;
    if (s->found.count)
        qsort(s->found.words, s->found.count, sizeof *s->found.words, compare);
    free(folder);
    free(wide);
}

static wchar_t *unmarked(const wchar_t *word)
{
    wchar_t *copy = _wcsdup(word);
    for (wchar_t *c = copy; c && *c; c++)
        *c = *c == QUOTED_STAR ? L'*' : *c == QUOTED_QUESTION ? L'?' : *c;
    return copy;
}

/* Adds a word of the command line to the arguments, with wildcards expanded. Keeps a word that begins with - or matches
   no file. */
static void take_word(word_list *list, const wchar_t *word)
{
    search s = {.path = word};
    if (!wcscmp(word, L"/?")) {
        add_word(list, _wcsdup(L"--help"));
        return;
    }
    if (*word != L'-' && wcspbrk(name_of(word), L"*?"))
        find(&s);
    if (!s.found.count)
        add_word(list, unmarked(word));
    for (size_t i = 0; i < s.found.count; i++) {
        add_word(list, s.found.words[i]);
        s.found.words[i] = NULL;
    }
    list->incomplete |= s.found.incomplete;
    free_words(&s.found);
}

static void split_line(word_list *list)
{
    const wchar_t *given = GetCommandLineW();
    wchar_t *line = malloc((2 * wcslen(given) + 1) * sizeof *line), **words = NULL;
    int count = 0;
    if (line) {
        if (mark_quoted(line, given, 0))
            mark_quoted(line, given, 1);
        words = CommandLineToArgvW(line, &count);
    }
    list->incomplete = !words;
    for (int i = 0; words && i < count; i++)
        if (i)
            take_word(list, words[i]);
        else
            add_word(list, unmarked(words[i]));
    LocalFree(words);
    free(line);
}

void win32_arguments(int *argc, char ***argv)
{
    word_list list = {0};
    split_line(&list);
    char **texts = list.incomplete ? NULL : calloc(list.count + 1, sizeof *texts);
    for (size_t i = 0; texts && i < list.count; i++)
        if (!(texts[i] = win32_narrow(list.words[i])))
            return;
    if (texts) {
        *argc = (int)list.count;
        *argv = texts;
    }
    free_words(&list);
}
