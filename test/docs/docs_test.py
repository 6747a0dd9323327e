"""What README and docs name exists: links, files, names of the code, options of the configuration, of programs and of launch files."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
SOURCES = ("include", "src", "tools", "scripts", "bench", "examples", "msg", "test", "launch", "cmake")
FOLDERS = ("docs", "config", "scripts", "tools", "test", "include", "src", "bench", "examples", "launch", "msg", "rviz")
ROOMS = [folder.name for folder in (ROOT / "include" / "mba_vo").iterdir() if folder.is_dir()]


def text_of(page):
    return page.read_text(encoding="utf-8")


def without_blocks(text):
    return re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)


def anchors(page):
    """Of headings, as they are made from their text, and those that are written."""
    text = without_blocks(text_of(page))
    found = set(re.findall(r'<a id="([^"]+)">', text))
    for heading in re.findall(r"^#+ (.*)$", text, flags=re.M):
        plain = re.sub(r"<[^>]*>|[`*]", "", re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)).strip().lower()
        found.add(re.sub(r"[^\w\- ]", "", plain).replace(" ", "-"))
    return found


def code(page):
    """What stands between backticks."""
    return re.findall(r"`([^`\n]+)`", without_blocks(text_of(page)))


def options_of(file):
    """Keys of a configuration, with dots."""
    keys, path = set(), []
    for match in re.finditer(r"^( *)(\w+):", text_of(file), flags=re.M):
        path = path[:len(match[1]) // 2] + [match[2]]
        keys.add(".".join(path))
    return keys


def exists(name):
    """A file or folder of the repository, or several, {a,b} and *."""
    if "{" in name or "*" in name:
        return any(ROOT.glob(re.sub(r"\{[^}]*\}", "*", name)))
    return (ROOT / name).exists()


class Docs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        files = [file for folder in SOURCES for file in (ROOT / folder).rglob("*")
                 if file.is_file() and "docs" not in file.relative_to(ROOT).parts and not file.name.endswith(".pyc")]
        texts = [file.read_text(encoding="utf-8", errors="replace") for file in files]
        cls.headers = [text for file, text in zip(files, texts) if file.suffix == ".h"]
        cls.text = "\n".join(texts)
        cls.words = set(re.findall(r"\w+", cls.text))
        cls.options = set(re.findall(r"--[a-z][a-z0-9-]+", cls.text + text_of(ROOT / "CMakeLists.txt")))
        cls.keys = options_of(ROOT / "config" / "default.yaml")

    def check(self, wrong):
        self.assertEqual([], sorted(set(wrong)))

    def test_links_lead_somewhere(self):
        wrong = []
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", without_blocks(text_of(page))):
                if "://" in target:
                    continue
                name, _, anchor = target.partition("#")
                file = page.parent / name if name else page
                if not file.exists() or anchor and anchor not in anchors(file):
                    wrong.append("%s: %s" % (page.relative_to(ROOT), target))
        self.check(wrong)

    def test_files_exist(self):
        wrong = []
        for page in PAGES:
            for name in re.findall(r"(?<![\w/.-])((?:%s)/[\w./{},*-]*\w)" % "|".join(FOLDERS), text_of(page)):
                if not exists(name) and not exists("docs/" + name):
                    wrong.append("%s: %s" % (page.relative_to(ROOT), name))
            for name in code(page):
                if re.fullmatch(r"(?:%s)/(\w+(\.h|\.cpp)|\w+_\w+)" % "|".join(ROOMS), name) and not name.startswith(FOLDERS):
                    stem = name if name.endswith((".h", ".cpp")) else name + ".h"
                    is_ros_name = stem != name and (name.replace("/", ".") in self.keys or '"%s"' % name in self.text)
                    if not is_ros_name and not exists("include/mba_vo/" + stem) and not exists("src/" + stem):
                        wrong.append("%s: %s" % (page.relative_to(ROOT), name))
        self.check(wrong)

    def test_names_are_those_of_the_code(self):
        wrong = []
        for page in PAGES:
            for name in code(page):
                if re.fullmatch(r"[A-Z]\w+(::\w+)+(\(\))?", name):
                    kind, member = name.split("::")[0], name.rstrip("()").split("::")[-1]
                    declared = re.compile(r"\b(class|struct) %s\b" % kind)
                    used = re.compile(r"\b%s\b" % member)
                    if not any(declared.search(text) and used.search(text) for text in self.headers):
                        wrong.append("%s: %s" % (page.relative_to(ROOT), name))
                elif re.fullmatch(r"(?:[A-Za-z][a-z0-9]+|k)(?:[A-Z][a-z0-9]*)+(?:\(\))?", name):
                    if name.rstrip("()") not in self.words:
                        wrong.append("%s: %s" % (page.relative_to(ROOT), name))
        self.check(wrong)

    def test_options_are_those_of_the_configuration(self):
        sections = {key for key in self.keys if "." not in key}
        fields = set(re.findall(r"\w+", "\n".join(text_of(file) for file in (ROOT / "msg").glob("*.msg"))))
        wrong = []
        for page in PAGES:
            for name in code(page):
                option = re.match(r"((?:%s)(?:\.\w+)+)(?:: .*)?$" % "|".join(sections), name)
                if option and option[1] not in self.keys and option[1].split(".", 1)[1] not in fields:
                    wrong.append("%s: %s" % (page.relative_to(ROOT), name))
        self.check(wrong)

    def test_accuracy_in_the_readme_is_that_of_the_page_of_results(self):
        def rows(text, heading):
            section = text[text.index(heading):]
            lines = re.split(r"\n## ", section)[1 if section.startswith("\n## ") else 0].splitlines()
            return [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]

        told = rows(text_of(ROOT / "README.md"), "\n## Accuracy")
        results = text_of(ROOT / "docs" / "results.md")
        live = {row[0]: row for row in rows(results, "\n## As published, live")}
        smoothed = {row[0]: row for row in rows(results, "\n## Smoothed")}
        for column, name in enumerate(told[0][1:], start=1):
            name = name.split("`")[0]
            self.assertEqual("%s mm, %s %%" % (live[name][1].split()[0], live[name][4]), told[2][column])
            self.assertEqual("%s mm" % smoothed[name][2].split()[0], told[3][column])

    def test_options_of_programs_exist(self):
        foreign = {"--cpu-list", "--build", "--target", "--prefix", "--install"}
        foreign |= {"--graphdef", "--inputs", "--inputs-as-nchw", "--opset", "--outputs", "--outputs-as-nchw"}  # tf2onnx
        wrong = ["%s: %s" % (page.relative_to(ROOT), option) for page in PAGES
                 for option in re.findall(r"(?<![\w-])--[a-z][a-z0-9-]+", text_of(page))
                 if option not in self.options | foreign and '"%s"' % option[2:].replace("-", "_") not in self.text]
        self.check(wrong)

    def test_launch_files_take_the_arguments_that_are_told(self):
        wrong, seen = [], 0
        for page in PAGES:
            for name, told in re.findall(r"roslaunch mba_vo (\w+)\.launch((?:\\\n|[^\n`])*)", text_of(page)):
                taken = re.findall(r'<arg name="(\w+)"', text_of(ROOT / "launch" / (name + ".launch")))
                told = re.findall(r"(?<!\S)(\w+):=", told.split("#")[0])
                seen += len(told)
                wrong += ["%s: %s.launch %s:=" % (page.relative_to(ROOT), name, arg) for arg in told if arg not in taken]
        self.check(wrong)
        self.assertGreater(seen, 20)

    def test_programs_that_are_told_exist(self):
        tools = {path.stem for folder in ("tools", "tools/ros") for path in (ROOT / folder).iterdir() if path.is_file()}
        told = {(page, name) for page in PAGES for name in re.findall(r"rosrun mba_vo ([a-z]\w+)", text_of(page))}
        self.check(["%s: rosrun mba_vo %s" % (page.relative_to(ROOT), name) for page, name in told if name not in tools])
        self.assertGreater(len(told), 10)


if __name__ == "__main__":
    unittest.main()
