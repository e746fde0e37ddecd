// Columns of other programs: named by the user, recognised, or left unchanged.
#include "check/foreign_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "check/check_files.h"
#include "text/message.h"

namespace polhode {
namespace {

// Parses a table with these columns.
TrajectoryFile read_foreign(const std::string& text, const ColumnNames& names, bool several = false) {
    return parse_foreign_trajectory(text, "f", find_foreign_columns(text, "f", names, several).columns);
}
TrajectoryFile read_foreign(const std::string& text, const std::string& names) {
    return read_foreign(text, parse_columns(names));
}

TEST(ForeignTable, ColumnsOfTheUsersOwn) {
    const ColumnNames names =
        parse_columns("time=clock,rotation=a:b:c:d,angular_velocity=u:v:w,position=x:y:z,velocity=k:l:m");
    const std::string text = "clock,note,a,b,c,d,u,v,w,x,y,z,k,l,m\n0,hello,0.1,0.2,0.3,0.9,1,2,3,4,5,6,7,8,9\n";
    const ForeignTable table = find_foreign_columns(text, "f", names);
    const TrajectoryFile file = read_foreign(text, names);
    ASSERT_EQ(file.rows.size(), 1U);
    EXPECT_EQ(file.rows[0].q, (Quaternion<double>{0.9, 0.1, 0.2, 0.3}));
    EXPECT_EQ(file.rows[0].angular_velocity_W, (Vector3<double>{1, 2, 3}));
    EXPECT_EQ(file.rows[0].position_W, (Vector3<double>{4, 5, 6}));
    EXPECT_EQ(file.rows[0].velocity_W, (Vector3<double>{7, 8, 9}));
    ASSERT_EQ(table.remarks.size(), 2U);
    EXPECT_NE(table.remarks[1].find("note"), std::string::npos);
}

TEST(ForeignTable, NamesInCommonUseAreKnown) {
    for (const char* header :
         {"Time,Rotation.x,Rotation.y,Rotation.z,Rotation.w", "timestamp,quat_x,quat_y,quat_z,quat_w", "T,QX,QY,QZ,QW",
          "time,orientation_x,orientation_y,orientation_z,orientation_w"}) {
        const TrajectoryFile file = read_foreign(std::string(header) + "\n0.5,0.1,0.2,0.3,0.9\n", ColumnNames());
        EXPECT_EQ(file.rows[0].t, 0.5) << header;
        EXPECT_EQ(file.rows[0].q, (Quaternion<double>{0.9, 0.1, 0.2, 0.3})) << header;
    }
}

TEST(ForeignTable, AMatrixRowByRow) {
    // a rotation by 90 degrees about z
    const char* const rows = "time=t,rotation=a:b:c:d:e:f:g:h:i";
    const Quaternion<double> q = read_foreign("t,a,b,c,d,e,f,g,h,i\n0,0,-1,0,1,0,0,0,0,1\n", rows).rows[0].q;
    EXPECT_NEAR(q.w, std::sqrt(0.5), 1e-15);
    EXPECT_NEAR(q.z, std::sqrt(0.5), 1e-15);
    EXPECT_THROW(read_foreign("t,a,b,c,d,e,f,g,h,i\n0,0,-1,0,1,0,0,0,0,-1\n", rows), InputError);
}

TEST(ForeignTable, AMatrixColumnByColumn) {
    const char* const columns = "time=t,matrix_by_columns=a:b:c:d:e:f:g:h:i";
    const std::string text = "t,a,b,c,d,e,f,g,h,i\n0,0,1,0,-1,0,0,0,0,1\n";
    EXPECT_NEAR(read_foreign(text, columns).rows[0].q.z, std::sqrt(0.5), 1e-15);
    EXPECT_THROW(read_foreign(text, std::string(columns) + ",euler_zyx=a:b:c"), InputError);
}

// Checked by hand: yaw by 90 degrees maps x to y, then pitch by 90 degrees rotates about the new y, which is -x.
TEST(ForeignTable, EulerAnglesOfANamedSequence) {
    ColumnNames names = parse_columns("time=t,euler_zyx=yaw:pitch:roll");
    names.degrees = true;
    const Quaternion<double> q = read_foreign("t,roll,pitch,yaw\n0,0,90,90\n", names).rows[0].q;
    EXPECT_LT(angle_between(rotate(q, Vector3<double>(1, 0, 0)), Vector3<double>(0, 0, -1)), 1e-15);
    EXPECT_LT(angle_between(rotate(q, Vector3<double>(0, 1, 0)), Vector3<double>(-1, 0, 0)), 1e-15);
    EXPECT_THROW(parse_columns("time=t,euler_zzx=a:b:c"), std::invalid_argument);
    EXPECT_THROW(read_foreign("t,a,b,c\n0,1,x,2\n", "time=t,euler_xyz=a:b:c"), InputError);
}

TEST(ForeignTable, AColumnMayServeTwice) {
    const TrajectoryFile file = read_foreign("t,w,x,y,z,none\n0,1,0,0,0,0\n",
                                             "time=t,rotation=x:y:z:w,position=none:none:none,velocity=none:none:none");
    EXPECT_TRUE(file.has_position && file.has_velocity);
    EXPECT_EQ(file.rows[0].q, (Quaternion<double>{1, 0, 0, 0}));
}

// The order of the file counts, whatever the names are.
TEST(ForeignTable, QuaternionsInTheOrderOfTheColumns) {
    const std::string text = "time,rot_x,rot_y,rot_z,rot_w\n0,0.9,0.1,0.2,0.3\n";
    const ForeignColumns columns = find_foreign_columns(text, "f", {}).columns;
    const auto q = [&](QuaternionColumns order) {
        return parse_foreign_trajectory(text, "f", columns, order).rows[0].q;
    };
    EXPECT_EQ(q(QuaternionColumns::scalar_first), (Quaternion<double>{0.9, 0.1, 0.2, 0.3}));
    EXPECT_EQ(q(QuaternionColumns::scalar_last), (Quaternion<double>{0.3, 0.9, 0.1, 0.2}));
}

TEST(ForeignTable, OwnAndUnknownTablesStayAsTheyAre) {
    for (const char* text : {"t,qw,qx,qy,qz\n0,1,0,0,0\n", "a,b,c\n1,2,3\n", "", "t,qw,qx,qy\n0,1,0,0\n"})
        EXPECT_TRUE(find_foreign_columns(text, "f", {}).columns.places.empty()) << text;
}

TEST(ForeignTable, SlipsAreNamed) {
    for (const char* words : {"", "time", "time=", "time=a:b", "rotation=a:b:c", "speed=a:b:c", "time=t,time=u"})
        EXPECT_THROW(parse_columns(words), std::invalid_argument) << words;
    EXPECT_THROW(read_foreign("a,b\n1,2\n", "time=t"), InputError);
    EXPECT_THROW(read_foreign("Time,qx,qy,qz,qw\n1,2\n", ColumnNames()), InputError);
}

// Returns the message of the InputError, or an empty string.
std::string fault_of(const std::string& text, const ColumnNames& names, std::vector<std::size_t>* gaps = nullptr) {
    CheckedFile checked;
    checked.path = "f";
    try {
        prepare_file(nullptr, {}, names, text, checked, gaps);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(ForeignTable, MessagesNameTheLinesOfTheFile) {
    const std::string header = "# made by hand\n# twice\ntime,rot_w,rot_x,rot_y,rot_z\n", row = ",1,0,0,0\n";
    const std::string good = header + "0" + row + "# between\n1" + row;  // six lines
    const auto begins = [](const std::string& fault, const std::string& place) {
        EXPECT_TRUE(fault.starts_with("f: " + place)) << fault;
    };
    EXPECT_EQ(fault_of(good, {}), "");
    begins(fault_of(good + "2,1,0,x,0\n", {}), "line 7, column rot_y: x is not a number");
    begins(fault_of(good + "# more\n2,1,0\n", {}), "line 8: has 3 cells under 5 columns");
    begins(fault_of(good + "1" + row, {}), "line 7, column time: 1 s is not after");
    begins(fault_of(good + "2,0,0,0,0\n", {}), "line 7, columns qw,qx,qy,qz: have length 0");
    begins(fault_of(good, parse_columns("time=clock")), "line 3: has no column clock");
    begins(fault_of(good, parse_columns("time=time")), "line 3: column qw is missing");
    // skipped rows count as lines
    std::vector<std::size_t> gaps;
    begins(fault_of(good + "2,nan,0,0,0\n3" + row + "x" + row, {}, &gaps), "line 9, column time: x is not a number");
    const ColumnNames matrix = parse_columns("time=t,rotation=a:b:c:d:e:f:g:h:i");
    begins(fault_of("#\nt,a,b,c,d,e,f,g,h,i\n#\n0,1,0,0,0,1,0,0,0,1\n#\n1,0,-1,0,1,0,0,0,0,-1\n", matrix), "line 6: ");
    begins(fault_of("#\nt,a,b,c\n#\n0,1,1,1\n#\n1,1,?,1\n", parse_columns("time=t,euler_xyz=a:b:c")),
           "line 6, column b: ? is not a number");
}

}  // namespace
}  // namespace polhode
